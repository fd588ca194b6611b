// Draws every section of a report without a browser and uses every control: node draw.mjs REPORT.json
import { readFile } from 'node:fs/promises';
import { openPage } from './page_stub.mjs';

const json = await readFile(process.argv[2], 'utf8');
const view = openPage(json);
await import('../src/main.js');
await new Promise((resolve) => setTimeout(resolve, 0));

const sections = JSON.parse(json).pages;
const drawn = view.pages.querySelectorAll('section');
if (drawn.length !== sections.length) throw new Error(`${drawn.length} of ${sections.length} sections are drawn`);
for (const section of drawn) {
  if (section.textContent.length < 40) throw new Error(`section ${section.id} is empty`);
}

/** Every table and plot has a name for whoever does not see the page. */
function checkNames() {
  for (const table of view.pages.querySelectorAll('table')) {
    if (table.querySelectorAll('tr').length === 0) continue;
    const captions = table.querySelectorAll('caption');
    if (captions.length !== 1 || captions[0].textContent.trim() === '') throw new Error(`a table has no caption: ${table.textContent.slice(0, 60)}`);
    for (const head of table.querySelectorAll('th')) {
      if (!head.getAttribute('scope')) throw new Error(`a heading cell has no scope: ${head.textContent}`);
    }
  }
  for (const plot of view.pages.querySelectorAll('.plot')) {
    if (!(plot.getAttribute('aria-label') ?? '').startsWith('Plot: ')) throw new Error('a plot has no label');
  }
}
checkNames();

/** Headings go down one level at a time. */
const levels = view.pages.querySelectorAll('h1, h2, h3').map((node) => Number(node.tag[1]));
levels.forEach((level, k) => { if (k > 0 && level > levels[k - 1] + 1) throw new Error('a heading skips a level'); });

const chosen = view.pages.querySelectorAll('option').filter((option) => option.getAttribute('selected') !== null);

for (const node of view.pages.descendants()) {
  if (node.tag === 'button') node.dispatch('click');
  if (node.tag === 'input') node.dispatch('input', Object.assign(node, { value: '0.5' }));
  if (node.tag === 'select') {
    for (const option of node.children) node.dispatch('change', Object.assign(node, { value: option.getAttribute('value') }));
  }
  if (node.tag === 'td') ['mouseover', 'click', 'mouseleave'].forEach((name) => node.dispatch(name));
}
for (const button of view.sections.querySelectorAll('button')) button.dispatch('click');
for (const name of ['scroll', 'beforeprint', 'afterprint']) view.page.dispatch(name);
await new Promise((resolve) => setTimeout(resolve, 0));
checkNames();
console.log(`${drawn.length} sections, ${view.plots.length} plots`);
for (const option of chosen) console.log(`opens on ${option.textContent}`);
