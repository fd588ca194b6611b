// Pictures of the guide: node pictures.mjs CHROMIUM MODULES OUT CAMPAIGN.toml COMMAND [ARGUMENT...]
// Opens the campaign, adds the leading suspect twice, and leaves OUT/workbench.png (both added, the error fallen) and
// OUT/workbench-suspect.png (a suspect that is pointed at).
import path from 'node:path';
import { browserOf, open, start } from './browser.mjs';
import { ranked, until } from './steps.mjs';

const [chromium, modules, out, campaign, command, ...given] = process.argv.slice(2);
const program = start(command, [...given, campaign]);
program.child.on('exit', () => {});
const browser = await browserOf(modules).launch(chromium);
const url = await program.url;
const fail = (text) => { throw new Error(text); };
const { page } = await open(browser, url, { width: 1400, height: 1000 }, fail);
const picture = (name) => page.screenshot({ path: path.join(out, `${name}.png`) });
const toTop = () => page.evaluate(() => scrollTo(0, 0));

await ranked(page);
await page.locator('.suspect .row').first().hover();
await page.waitForTimeout(1000);
await toTop();
await picture('workbench-suspect');
for (let step = 1; step <= 2; step += 1) {
  await page.locator('.suspect .row').first().click();
  await until(page, (number) => document.querySelector('.chip.current')?.dataset.model === String(number), step);
  await until(page, () => ['fitted', 'contradicted'].includes(document.querySelector('.headline')?.dataset.standing));
  await ranked(page);
}
await page.mouse.move(5, 5);
await page.waitForTimeout(1500);
await toTop();
await picture('workbench');
await browser.close();
program.child.kill();
