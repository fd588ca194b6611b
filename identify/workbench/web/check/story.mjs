// The whole story of the workbench in headless Chromium, from load to export:
//   node story.mjs CHROMIUM MODULES OUT CAMPAIGN.toml COMMAND [ARGUMENT...]
// COMMAND with its arguments and the campaign serves the page and prints its address: `node mock_server.mjs PAGE.html`,
// or `volcal workbench --no-browser`. Pictures are left in OUT; every fault is a line, and the exit code is 1.
import { cp, mkdir, mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { browserOf, open, start } from './browser.mjs';
import { aloneWithKeys } from './keyboard.mjs';
import { badInput, looks, namesWithMarkup, serverGone, twoTabs } from './conditions.mjs';
import { steps } from './steps.mjs';

const [chromium, modules, out, campaign, command, ...given] = process.argv.slice(2);
const { launch, axe: axeFile } = browserOf(modules);
const folder = await mkdtemp(path.join(tmpdir(), 'volcal-story-'));
await cp(path.dirname(path.resolve(campaign)), folder, { recursive: true });
const copy = path.join(folder, path.basename(campaign));
await mkdir(out, { recursive: true });

const faults = [];
const began = performance.now();
const program = start(command, [...given, copy]);
program.child.on('exit', () => {});
const browser = await launch(chromium);
const axe = await readFile(axeFile, 'utf8');

/** One chapter: its faults carry its name, and a chapter that breaks off is a fault. */
async function chapter(name, tell) {
  const from = performance.now();
  const fault = (text) => faults.push(`${name}: ${text}`);
  try {
    await tell(fault);
  } catch (error) {
    fault(error.message.split('\n').slice(0, 3).join(' '));
  }
  console.log(`${name}: ${((performance.now() - from) / 1000).toFixed(1)} s`);
}

const url = await program.url;
const story = { url, browser, axe, out, campaign: copy, program, startOn: (file) => start(command, [...given, file]), wide: { width: 1400, height: 1000 } };
let current = () => {};
const main = await open(browser, url, story.wide, (text) => current(text));
story.main = main;
for (const [name, step] of steps) await chapter(name, async (fault) => { current = fault; await step(story, fault); });
for (const [name, view] of Object.entries(looks)) await chapter(name, (fault) => view(story, fault));
await chapter('keyboard alone', (fault) => aloneWithKeys(story, fault));
await chapter('two tabs', (fault) => { current = fault; return twoTabs(story, fault); });
await chapter('bad input, then mended', (fault) => { current = fault; return badInput(story, fault); });
if (command !== 'node') await chapter('names with markup', (fault) => { current = fault; return namesWithMarkup(story, fault); });
await chapter('server gone', (fault) => { current = fault; return serverGone(story, fault); });
await browser.close();
program.child.kill();
await rm(folder, { recursive: true });

for (const fault of faults) console.error(fault);
console.log(`${faults.length} faults in ${((performance.now() - began) / 1000).toFixed(0)} s`);
process.exitCode = faults.length > 0 ? 1 : 0;
