// The page under other conditions: narrow, dark, printed, with another tab, with bad input, without its program.
import { cp, mkdtemp, readdir, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { open } from './browser.mjs';
import { ranked, shot, until } from './steps.mjs';

async function fits(page, fault) {
  const [wide, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
  if (wide > screen) fault(`it is ${wide} px wide on a screen of ${screen}`);
}

/** Runs outside of the page's policy, since the page lets nothing in. */
async function accessible({ axe }, page, fault) {
  const session = await page.context().newCDPSession(page);
  await session.send('Runtime.evaluate', { expression: axe });
  const { result } = await session.send('Runtime.evaluate', { expression: "axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => JSON.stringify(violations.map(({ id, help, nodes }) => [id, help, nodes.length, nodes[0].target.join(' ')])))", awaitPromise: true, returnByValue: true });
  for (const [id, help, count, where] of JSON.parse(result.value)) fault(`${id}: ${help} (${count}, as ${where})`);
  await session.detach();
}

async function lookAt(story, fault, name, view, further = () => {}) {
  const { page, context } = await open(story.browser, story.url, view, fault);
  await ranked(page);
  await page.waitForTimeout(1200);
  await fits(page, fault);
  await accessible(story, page, fault);
  await shot(page, story, name);
  await further(page);
  await context.close();
}

async function print(story, page, fault) {
  const pdf = await page.pdf({ path: path.join(story.out, 'paper.pdf'), preferCSSPageSize: true, printBackground: true });
  const sheets = pdf.toString('latin1').match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  if (sheets === 0 || sheets > 8) fault(`${sheets} sheets; at most 8 are sensible`);
}

export const looks = {
  wide: (story, fault) => accessible(story, story.main.page, fault).then(() => fits(story.main.page, fault)),
  phone: (story, fault) => lookAt(story, fault, 'phone', { width: 360, height: 740 }),
  'dark, without motion, then on paper': (story, fault) => lookAt(story, fault, 'dark', { ...story.wide, scheme: 'dark', motion: 'reduce' }, (page) => print(story, page, fault)),
};

const kReadOnly = '.banner button:text("Write here")';

export async function twoTabs(story, fault) {
  const first = story.main.page;
  const second = await open(story.browser, story.url, story.wide, fault);
  await second.page.locator(kReadOnly).waitFor({ timeout: 20_000 });
  if (await second.page.locator('.chip:not(.current) .model:not(:disabled)').count() > 0) fault('a tab that only reads lets its models be changed');
  await second.page.locator(kReadOnly).click();
  await first.locator(kReadOnly).waitFor({ timeout: 20_000 });
  await first.locator(kReadOnly).click();
  await until(first, () => ![...document.querySelectorAll('.banner button')].some((node) => node.textContent === 'Write here'), null, 20_000);
  await second.context.close();
}

/** A program of its own, started on a campaign that is wrong. */
export async function badInput(story, fault) {
  const good = await readFile(story.campaign, 'utf8');
  const folder = await mkdtemp(path.join(tmpdir(), 'volcal-story-'));
  await cp(path.dirname(story.campaign), folder, { recursive: true, filter: (from) => !from.endsWith('workbench') });
  const file = path.join(folder, path.basename(story.campaign));
  await writeFile(file, good.replace(/^instrument = "[^"]*"/m, 'instrument = "laser-trcer"'));
  const program = story.startOn(file);
  program.child.on('exit', () => {});
  const { page, context } = await open(story.browser, await program.url, story.wide, fault);
  await page.locator('.bad-input .wrong').waitFor({ timeout: 30_000 });
  const text = await page.locator('.bad-input').textContent();
  if (!/line \d+/.test(text) || !text.includes('laser-trcer')) fault('bad input is not shown with its line');
  await accessible(story, page, fault);
  await shot(page, story, 'bad-input');
  await writeFile(file, good);
  await until(page, () => document.querySelector('.headline') && !document.querySelector('.bad-input'));
  await ranked(page);
  await context.close();
  program.child.kill();
  await rm(folder, { recursive: true, force: true });
}

/** What would run if a name were taken for markup: it would change the title of the page. */
const markup = (what) => `<img src=x onerror=document.title=${what}>`;

/** The campaign with a folder, machine, set-ups, a station and a temperature that are called so. */
async function calledByMarkup(story) {
  const folder = path.join(await mkdtemp(path.join(tmpdir(), 'volcal-story-')), markup('folder'));
  await cp(path.dirname(story.campaign), folder, { recursive: true, filter: (from) => !from.endsWith('workbench') });
  const file = path.join(folder, path.basename(story.campaign));
  const rewritten = async (name, change) => writeFile(path.join(folder, name), change(await readFile(path.join(folder, name), 'utf8')));
  await rewritten(path.basename(file), (text) => text.replace(/^name = "([^"]*)"/gm, (_, name) => `name = "${markup('setup')} ${name}"`).replace(/^station = "P2"/gm, `station = "${markup('station')}"`));
  await rewritten('machine.toml', (text) => text.replace(/^name = .*/m, `name = "${markup('machine')}"`));
  for (const name of await readdir(folder)) if (name.endsWith('.csv')) await rewritten(name, (text) => text.replace('T_column_degC', `T_${markup('column')}_degC`));
  return file;
}

/** Names are texts, whatever stands in them: of campaign, machine, set-ups, columns and effects, and of what was added. */
export async function namesWithMarkup(story, fault) {
  const file = await calledByMarkup(story);
  const program = story.startOn(file);
  program.child.on('exit', () => {});
  const { page, context } = await open(story.browser, await program.url, story.wide, fault);
  await ranked(page);
  const title = await page.title();
  for (const what of ['folder', 'machine', 'setup']) if (await page.locator('body').evaluate((body, text) => !(body.innerText + [...body.querySelectorAll('[title], option')].map((node) => node.title + node.textContent).join()).includes(text), markup(what))) fault(`the name of the ${what} is not shown as it is written`);
  const variables = await page.locator('.lens').first().locator('select').nth(1).locator('option').evaluateAll((list) => list.map(({ value, textContent }) => [value, textContent]));
  const column = variables.find(([value]) => value.includes(markup('column')));
  if (!column) fault('the column with markup in its name cannot be chosen');
  else await page.locator('.lens').first().locator('select').nth(1).selectOption(column[0]);
  await page.locator('.suspects details summary').evaluateAll((list) => list.forEach((node) => node.click()));
  await page.waitForTimeout(500);
  const named = page.locator('.suspect, .not-visible li').filter({ hasText: markup('column') });
  if (await named.count() === 0) fault('no effect of the column with markup in its name is listed');
  else await named.first().hover();
  await page.waitForTimeout(500);
  const called = page.locator('.suspect').filter({ has: page.locator('.title b', { hasText: markup('column') }) });
  const add = called.locator('.add[aria-disabled="false"]').first();
  const chips = await page.locator('.chip').count();
  if (await add.count() > 0) {
    await add.click();
    await until(page, (n) => document.querySelectorAll('.chip').length > n, chips);
    if (!(await page.locator('.chip').last().textContent()).includes(markup('column'))) fault('the model is not called by what was added');
  }
  await page.locator('.drawn-ladder summary').click();
  await page.getByRole('combobox', { name: 'Formula' }).fill(`EXX += dir_x * ${markup('formula')}`);
  await page.locator('.problem').waitFor();
  await page.waitForTimeout(800);
  await shot(page, story, 'markup');
  if (await page.title() !== title) fault(`markup in the name of the ${await page.title()} was run`);
  if (await page.locator('img').count() > 0) fault('a name became an element');
  await context.close();
  program.child.kill();
  await rm(path.dirname(path.dirname(file)), { recursive: true, force: true });
}

export async function serverGone(story, fault) {
  const { page, quiet } = story.main;
  quiet.on = true;
  story.program.child.kill();
  await page.locator('.banner:has-text("does not answer"), .banner:has-text("has ended")').first().waitFor({ timeout: 30_000 });
  if (await page.getByRole('button', { name: 'Try again' }).count() + await page.locator('.banner:has-text("has ended")').count() === 0) fault('no retry is offered');
  if (await page.locator('.suspect .add[aria-disabled="false"]').count() > 0) fault('without the program suspects can still be added');
  await shot(page, story, 'gone', false);
}
