// The page under other conditions: narrow, dark, printed, with another tab, with bad input, without its program.
import { cp, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
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

async function lookAt(story, fault, name, view) {
  const { page, context } = await open(story.browser, story.url, view, fault);
  await ranked(page);
  await page.waitForTimeout(1200);
  await fits(page, fault);
  await accessible(story, page, fault);
  await shot(page, story, name);
  await context.close();
}

async function print(story, fault) {
  const { page, context } = await open(story.browser, story.url, { ...story.wide, scheme: 'dark' }, fault);
  await ranked(page);
  await page.waitForTimeout(1000);
  const pdf = await page.pdf({ path: path.join(story.out, 'paper.pdf'), preferCSSPageSize: true, printBackground: true });
  const sheets = pdf.toString('latin1').match(/\/Type\s*\/Page\b/g)?.length ?? 0;
  if (sheets === 0 || sheets > 8) fault(`${sheets} sheets; at most 8 are sensible`);
  await context.close();
}

export const looks = {
  wide: (story, fault) => accessible(story, story.main.page, fault).then(() => fits(story.main.page, fault)),
  phone: (story, fault) => lookAt(story, fault, 'phone', { width: 360, height: 740 }),
  dark: (story, fault) => lookAt(story, fault, 'dark', { ...story.wide, scheme: 'dark' }),
  'without motion': (story, fault) => lookAt(story, fault, 'still', { ...story.wide, motion: 'reduce' }),
  paper: print,
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

export async function serverGone(story, fault) {
  const { page, quiet } = story.main;
  quiet.on = true;
  story.program.child.kill();
  await page.locator('.banner:has-text("does not answer"), .banner:has-text("has ended")').first().waitFor({ timeout: 30_000 });
  if (await page.getByRole('button', { name: 'Try again' }).count() + await page.locator('.banner:has-text("has ended")').count() === 0) fault('no retry is offered');
  if (await page.locator('.suspect .add[aria-disabled="false"]').count() > 0) fault('without the program suspects can still be added');
  await shot(page, story, 'gone', false);
}
