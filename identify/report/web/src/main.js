// Builds the page from the JSON document: section list at the side, one section per entry of `pages`.
import { el } from './dom.js';
import { renderers } from './pages.js';
import { nameParts, watchFrames } from './names.js';
import { drawForPaper, redrawAll, wakeScenes } from './plot.js';
import { onPrint, onThemeChange, themeSwitch } from './theme.js';

function section(page, index) {
  const body = el('div', { class: 'body' });
  const node = el('section', { id: page.kind, class: `page page-${page.kind}` }, [
    el('h2', { class: index === 0 ? 'hidden' : null }, page.title),
    body,
  ]);
  const render = renderers[page.kind];
  if (!render) throw new Error(`no renderer for section "${page.kind}"`);
  render(body, page.data);
  nameParts(body, page.title);
  return node;
}

function sectionList(pages) {
  return el('ol', {}, pages.map((page) => el('li', {}, el('a', { href: `#${page.kind}` }, page.title))));
}

function markCurrentSection(nav, sections) {
  const links = new Map([...nav.querySelectorAll('a')].map((a) => [a.getAttribute('href').slice(1), a]));
  const update = () => {
    const reached = sections.filter((node) => node.getBoundingClientRect().top < 120);
    const current = (reached.at(-1) ?? sections[0]).id;
    for (const [id, link] of links) {
      if (id === current) link.setAttribute('aria-current', 'true');
      else link.removeAttribute('aria-current');
    }
  };
  addEventListener('scroll', update, { passive: true });
  update();
}

function start() {
  const report = JSON.parse(document.getElementById('volcal-data').textContent);
  const nav = document.getElementById('sections');
  const main = document.getElementById('pages');
  document.documentElement.classList.toggle('upright', report.paper === 'upright');
  nav.append(
    el('div', { class: 'brand' }, [el('strong', {}, 'volcal'), ' report']),
    el('div', { class: 'machine' }, [report.title, report.date ? el('div', { class: 'muted' }, report.date) : null]),
    sectionList(report.pages),
    themeSwitch(),
  );
  main.replaceChildren(
    el('header', {}, [
      el('h1', {}, report.title),
      el('p', { class: 'muted' }, [report.subtitle, report.date ? `, ${report.date}` : '', report.version ? `, volcal ${report.version}` : ''].join('')),
      report.command ? el('p', { class: 'command' }, el('code', {}, report.command)) : null,
    ]),
  );
  const sections = report.pages.map(section);
  main.append(...sections);
  markCurrentSection(nav, sections);
  watchFrames(main);
  wakeScenes(main);
  onThemeChange(redrawAll);
  onPrint(drawForPaper);
}

start();
