// Looks at reports in headless Chromium: node check.mjs CHROMIUM MODULES OUT REPORT.html...
// Wide, on a phone and dark: rules of WCAG 2 A and AA by axe, nothing wider than the screen, no request, no error.
// On paper: the number of sheets. Pictures and PDF are left in OUT.
import { mkdir, readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import path from 'node:path';

const [chromium, modules, out, ...reports] = process.argv.slice(2);
const requireFrom = createRequire(path.join(path.resolve(modules), 'package.json'));
const { chromium: browserType } = requireFrom('playwright-core');
const axe = await readFile(requireFrom.resolve('axe-core/axe.min.js'), 'utf8');

const kMostSheets = 16;
const kViews = [['wide', 1400, 1000, 'light'], ['dark', 1400, 1000, 'dark'], ['phone', 360, 740, 'light']];
const flags = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

const faults = [];
const browser = await browserType.launch({ executablePath: chromium, args: flags });
await mkdir(out, { recursive: true });

async function open(file, view, fault) {
  const [, width, height, colorScheme] = view;
  const context = await browser.newContext({ viewport: { width, height }, colorScheme, bypassCSP: true });
  const page = await context.newPage();
  page.on('pageerror', (error) => fault(`the page throws: ${error.message}`));
  page.on('console', (message) => { if (message.type() === 'error') fault(`the page says: ${message.text()}`); });
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) fault(`the page asks for ${request.url()}`); });
  await page.goto(`file://${path.resolve(file)}`);
  return { context, page };
}

/** Scrolls through the page, so that every plot is drawn. */
async function drawn(page) {
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  for (let y = 0; y < height + 2000; y += 600) {
    await page.evaluate((to) => scrollTo(0, to), y);
    await page.waitForTimeout(40);
  }
  await page.evaluate(() => scrollTo(0, 0));
}

async function look(file, name, view) {
  const fault = (text) => faults.push(`${file}, ${view[0]}: ${text}`);
  const { context, page } = await open(file, view, fault);
  await drawn(page);
  const [wide, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
  if (wide > screen) fault(`it is ${wide} px wide on a screen of ${screen}`);
  const scene = await page.$('.scene');
  if (scene) {
    await scene.scrollIntoViewIfNeeded();
    const box = await scene.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    const from = await page.evaluate(() => scrollY);
    await page.mouse.wheel(0, 300);
    await page.waitForTimeout(700);
    if (await page.evaluate(() => scrollY) === from) fault('the wheel over a picture in space does not scroll the page');
  }
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => axe.run(document, { resultTypes: ['violations'] }));
  for (const { id, help, nodes } of violations) fault(`${id}: ${help} (${nodes.length}, as ${nodes[0].target.join(' ')})`);
  await page.screenshot({ path: path.join(out, `${name}-${view[0]}.png`), fullPage: true });
  await context.close();
}

/** Printed from a dark page of which nothing was scrolled into view. */
async function print(file, name) {
  const fault = (text) => faults.push(`${file}, on paper: ${text}`);
  const { context, page } = await open(file, ['paper', 1400, 1000, 'dark'], fault);
  await page.waitForTimeout(500);
  const pdf = await page.pdf({ path: path.join(out, `${name}.pdf`), preferCSSPageSize: true, printBackground: true });
  const sheets = pdf.toString('latin1').match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  if (sheets === 0 || sheets > kMostSheets) fault(`${sheets} sheets; at most ${kMostSheets} are sensible`);
  await context.close();
  return sheets;
}

for (const file of reports) {
  const name = path.basename(path.dirname(path.resolve(file)));
  for (const view of kViews) await look(file, name, view);
  console.log(`${file}: ${await print(file, name)} sheets`);
}
await browser.close();
for (const fault of faults) console.error(fault);
process.exitCode = faults.length > 0 ? 1 : 0;
