// Somebody who has read nothing outlines the bump of a hidden campaign, and with VOLCAL_LONG_TESTS=1 names both
// effects of another, by what the page says alone, accessible names and texts; then the script that was exported makes
// the confirmed numbers again, to the bit.
//   node acceptance.mjs CHROMIUM MODULES VOLCAL DATASETS
// Only the judge, who comes after, knows the sealed answers and asks the program for its numbers.
import { spawnSync } from 'node:child_process';
import { cp, mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { browserOf, open, start } from './browser.mjs';

const kMinutes = 5;
const kLong = { timeout: 300_000 };
const kMostSteps = 8;

/** A person at the page, who sees names and texts. */
class Player {
  constructor(page) {
    this.page = page;
    this.missing = page.getByRole('region', { name: 'What is missing?' });
  }

  /** Until the page is done with what was clicked. */
  async settled() {
    await this.missing.getByText(/\d+ tests of /).waitFor(kLong);
    await this.missing.getByText('What has no name is being looked for.').waitFor({ state: 'detached', ...kLong });
    await this.page.getByRole('progressbar').waitFor({ state: 'detached', ...kLong });
  }

  async confirm() {
    const button = this.page.getByRole('button', { name: 'Confirm by a full fit' });
    if (await this.page.getByText(/^(linear preview|refit): .*(as before the step|not yet a full fit)/).count() > 0) await button.click();
    await this.page.getByText(/^(confirmed by a full fit|the full fit contradicts what stood before)/).waitFor(kLong);
    await this.settled();
  }

  /** What stands first, as long as something does. */
  async addWhatIsMissing() {
    for (let step = 0; step < kMostSteps; step += 1) {
      await this.settled();
      const first = this.missing.getByRole('button', { name: /^add / }).first();
      if (await first.count() === 0) return;
      const label = (await first.getAttribute('aria-label')).replace(/^add /, '');
      await first.click();
      await this.missing.getByRole('button', { name: `take out: ${label}`, exact: true }).waitFor(kLong);
      await this.confirm();
    }
  }

  namesInModel() {
    return this.missing.getByRole('button', { name: /^take out: / }).evaluateAll((list) => list.map((node) => node.getAttribute('aria-label').replace(/^take out: /, '')));
  }

  /** "Largest -4.1 ± 0.5 µm at X = 3 mm, Y = -10 mm; at least half of it from X = -88 mm to 90 mm and ..." */
  async outlineFirst() {
    await this.settled();
    await this.missing.getByRole('button', { name: /^Draw the surface/ }).first().click();
    const sentence = await this.missing.getByText(/^Largest .* at least half of it/).first().textContent(kLong);
    const numbers = (text) => text.match(/[-−]?\d+(\.\d+)?(e-?\d+)?/g).map((word) => Number(word.replace('−', '-')));
    const [what, where] = sentence.split(';');
    await this.missing.getByRole('button', { name: 'Add the surface' }).first().click();
    await this.page.getByText(/^confirmed by a full fit/).waitFor(kLong);
    await this.settled();
    return { sentence, axes: [...what.matchAll(/([A-Za-z]\w*) = /g)].map(([, name]) => name), at: numbers(what.split(' at ')[1]), extent: where.split(' and ').map(numbers) };
  }

  async export() {
    await this.page.getByRole('button', { name: 'Write the commands as a script' }).click();
    return (await this.page.getByText(/^commands: /).first().textContent(kLong)).replace(/^commands: /, '').trim();
  }
}

const [chromium, modules, volcal, datasets] = process.argv.slice(2);
const browser = await browserOf(modules).launch(chromium);
const faults = [];
const answers = JSON.parse(await readFile(path.join(datasets, 'sealed', 'answers.json'), 'utf8'));

/** A campaign alone, without the sealed answers beside it. */
async function played(name, play, judge) {
  const folder = await mkdtemp(path.join(tmpdir(), 'volcal-acceptance-'));
  await cp(path.join(datasets, name), path.join(folder, name), { recursive: true });
  await cp(path.join(datasets, 'machines'), path.join(folder, 'machines'), { recursive: true });
  const program = start(volcal, ['workbench', '--no-browser', '--keep', path.join(folder, name, 'campaign.toml')]);
  program.child.on('exit', () => {});
  try {
    const url = await program.url;
    const { page, context } = await open(browser, url, { width: 1400, height: 1000 }, (text) => faults.push(`${name}: ${text}`));
    const begun = performance.now();
    const player = new Player(page);
    const said = await play(player);
    const minutes = (performance.now() - begun) / 60_000;
    console.log(`${name}: ${JSON.stringify(said)}, ${minutes.toFixed(1)} minutes`);
    if (minutes > kMinutes && !process.env.VOLCAL_SLOW) faults.push(`${name}: it takes ${minutes.toFixed(1)} minutes`);
    judge(said, (text) => faults.push(`${name}: ${text}`));
    const script = await player.export();
    await context.close();
    await sameToTheBit(url, script, (text) => faults.push(`${name}: ${text}`));
  } catch (error) {
    faults.push(`${name}: ${error.message.split('\n').slice(0, 4).join(' ')}`);
  }
  program.child.kill();
  await rm(folder, { recursive: true, force: true });
}

/** Models of the program that was looked at, and of the script that was exported. */
async function sameToTheBit(url, script, fault) {
  const [home, token] = url.split('#');
  const asked = await fetch(`${home}api/state`, { method: 'POST', headers: { 'X-Volcal-Token': token, 'X-Volcal-Tab': 'judge' }, body: '{}' });
  const { models, current } = await asked.json();
  const ran = spawnSync('sh', [script, '--json'], { env: { ...process.env, PATH: `${path.dirname(path.resolve(volcal))}:${process.env.PATH}` }, encoding: 'utf8', maxBuffer: 1 << 28 });
  if (ran.status !== 0) return fault(`the script ends with ${ran.status}: ${ran.stderr.slice(-400)}`);
  const again = JSON.parse(ran.stdout);
  const confirmed = (list) => JSON.stringify(list.filter(({ standing }) => !['preview', 'refitted'].includes(standing)));
  if (again.current !== current) fault(`the script ends at model ${again.current}, the page at ${current}`);
  if (confirmed(again.models) !== confirmed(models)) fault('the script does not make the confirmed numbers again');
  return console.log(`  the script makes ${models.length} models again, to the bit`);
}

/** "reversal:EXX:dir_x" is called "reversal EXX", "axis-coupling:ECX:z" "ECX by z". */
const callNames = { reversal: (target) => `reversal ${target}`, 'axis-coupling': (target, driver) => `${target} by ${driver}` };

if (process.env.VOLCAL_LONG_TESTS) await played('21', async (player) => {
  await player.addWhatIsMissing();
  return player.namesInModel();
}, (names, fault) => {
  const wanted = answers['21'].effects.map((each) => each.split(':')).map(([kind, ...rest]) => callNames[kind](...rest));
  const alike = (name, other) => name.toLowerCase().startsWith(other.toLowerCase());
  for (const each of wanted) if (!names.some((name) => alike(name, each))) fault(`${each} is not named`);
  for (const each of names) if (!wanted.some((other) => alike(each, other))) fault(`${each} is named, and is not there`);
});

const sealed = (await readFile(path.join(datasets, 'sealed', '23.toml'), 'utf8')).split('[[hidden]]')[1];
const key = (name) => Number(sealed.match(new RegExp(`^${name} = (.*)$`, 'm'))[1]);
await played('23', (player) => player.outlineFirst(), ({ axes, at, extent }, fault) => {
  const truth = { x: { centre: key('centre_mm'), width: key('width_mm') }, y: { centre: key('by_centre_mm'), width: key('by_width_mm') } };
  if (axes.map((name) => name.toLowerCase()).join() !== 'x,y') fault(`the bump is said to lie over ${axes}`);
  for (const [k, { centre, width }] of Object.values(truth).entries()) {
    const half = width * Math.sqrt(2 * Math.LN2); // where half of a Gaussian bump is left
    if (Math.abs(at[k] - centre) > 0.6 * half) fault(`the bump is at ${at[k]} mm along ${axes[k]}, not at ${centre}`);
    const reach = (Math.max(...extent[k].slice(0, 2)) - Math.min(...extent[k].slice(0, 2))) / 2;
    if (reach < 0.5 * half || reach > 2 * half) fault(`half of the bump reaches ${reach} mm along ${axes[k]}, not ${half.toFixed(0)}`);
  }
});

await browser.close();
for (const fault of faults) console.error(fault);
console.log(`${faults.length} faults`);
process.exitCode = faults.length > 0 ? 1 : 0;
