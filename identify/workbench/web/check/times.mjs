// Times from an input to the picture, medians and 95th percentiles:
//   node times.mjs CHROMIUM MODULES CAMPAIGN.toml COMMAND [ARGUMENT...]
// With VOLCAL_TIMES=brush:500,hover:2000 in the environment a median above so many ms is a fault, as is a kind of
// input that was not measured, an empty picture and an error of the page; the exit code is then 1. VOLCAL_TIMES_PICTURE
// names a file for a picture of the page.
import { browserOf, open, start } from './browser.mjs';
import { drag, inked, ranked, until } from './steps.mjs';

const [chromium, modules, campaign, command, ...given] = process.argv.slice(2);
const kTimes = 12;
const kLoad = 900_000; // ms, for the first full fit
const program = start(command, [...given, campaign]);
const browser = await browserOf(modules).launch(chromium);
const faults = [];
const { page } = await open(browser, await program.url, { width: 1400, height: 1000 }, (text) => faults.push(text));
await until(page, () => document.querySelector('.headline'), null, kLoad);
await ranked(page);
await page.waitForTimeout(2000);

const menu = page.locator('.lens').first().locator('select').nth(1);
const names = await menu.locator('option').evaluateAll((list) => list.map(({ value }) => value));
const pause = () => page.waitForTimeout(250);
for (let k = 0; k < kTimes; k += 1) {
  await menu.selectOption(names[k % names.length]);
  await pause();
}
for (let k = 0; k < 3; k += 1) await drag(page, 0, [0.2 + 0.1 * k, 0.1], [0.5 + 0.1 * k, 0.5]);
await page.keyboard.press('Escape');
const rows = page.locator('.suspect .row');
for (let k = 0; k < kTimes; k += 1) {
  await rows.nth(k % await rows.count()).hover();
  await pause();
}
for (let k = 0; k < 3; k += 1) {
  const model = await page.locator('.chip.current').getAttribute('data-model');
  if (await rows.count() === 0) break;
  await rows.first().click();
  await until(page, (old) => document.querySelector('.chip.current')?.dataset.model !== old, model);
  await ranked(page);
}
for (const [k, share] of (await inked(page, '.lens .canvas > canvas:first-child')).entries()) if (share < 0.005) faults.push(`picture ${k} is empty`);
if (process.env.VOLCAL_TIMES_PICTURE) await page.screenshot({ path: process.env.VOLCAL_TIMES_PICTURE, fullPage: true });
const entries = await page.evaluate(() => performance.getEntriesByType('measure').filter(({ name }) => name.startsWith('volcal:')).map(({ name, duration }) => [name, duration]));
const medians = new Map();
for (const name of [...new Set(entries.map(([each]) => each))]) {
  const list = entries.filter(([each]) => each === name).map(([, duration]) => duration).sort((a, b) => a - b);
  const at = (share) => list[Math.min(list.length - 1, Math.floor(share * list.length))].toFixed(0).padStart(6);
  medians.set(name.replace('volcal:', ''), Number(at(0.5)));
  console.log(`${name.padEnd(16)} median ${at(0.5)} ms, 95 % ${at(0.95)} ms, of ${list.length}`);
}
for (const [name, most] of (process.env.VOLCAL_TIMES ?? '').split(',').filter(Boolean).map((each) => each.split(':'))) {
  if (!(medians.get(name) <= Number(most))) faults.push(`${name} takes ${medians.get(name)} ms, at most ${most} are wanted`);
}
await browser.close();
program.child.kill();
for (const fault of faults) console.error(fault);
process.exitCode = faults.length > 0 ? 1 : 0;
