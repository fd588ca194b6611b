// Chapters of the story, in the one tab that writes.
import path from 'node:path';

const kLong = 180_000; // ms, for a full fit of a large campaign

export const shot = (page, story, name, fullPage = true) => page.screenshot({ path: path.join(story.out, `${name}.png`), fullPage });
export const until = (page, condition, argument, timeout = kLong) => page.waitForFunction(condition, argument, { timeout });

export const idle = (page) => until(page, () => document.querySelector('.headline') && !document.querySelector('.progress:not([data-behind])'));
export const ranked = async (page) => {
  await idle(page);
  await until(page, () => document.querySelector('.suspects') && !document.querySelector('.suspects.is-stale') && document.querySelector('.suspects .rows, .suspects .nothing'));
};

const headlineNow = (page) => page.evaluate(() => {
  const node = document.querySelector('.headline');
  return { error: Number(node.querySelector('.value').textContent.replace(/[^\d.]/g, '')), standing: node.dataset.standing, current: document.querySelector('.chip.current').dataset.model };
});

/** Once its number, which moves to a new value for 0.6 s, has stood still for longer than that. */
export async function headline(page) {
  let last = await headlineNow(page);
  for (let look = 0, still = 0; look < 50 && still < 4; look += 1) {
    await page.waitForTimeout(200);
    const now = await headlineNow(page);
    still = now.error === last.error && now.current === last.current ? still + 1 : 0;
    last = now;
  }
  return last;
}

/** Share of the pixels of a canvas that are drawn on. */
export const inked = (page, selector) => page.evaluate((which) => [...document.querySelectorAll(which)].map((canvas) => {
  const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let k = 3; k < data.length; k += 4) if (data[k] > 0) count += 1;
  return count / (canvas.width * canvas.height);
}), selector);

export async function drag(page, lens, from, to) {
  const box = await page.locator('.lens .above').nth(lens).boundingBox();
  const at = ([u, v]) => [box.x + u * box.width, box.y + v * box.height];
  await page.mouse.move(...at(from));
  await page.mouse.down();
  for (let k = 1; k <= 8; k += 1) await page.mouse.move(...at([0, 1].map((i) => from[i] + ((to[i] - from[i]) * k) / 8)));
  await page.mouse.up();
}

const sentence = (page) => page.locator('.marked .sentence').textContent();

async function load({ main: { page } }, fault) {
  await ranked(page);
  if (await page.locator('.chip').count() !== 1) fault('a new session does not show one model');
  if (!((await headline(page)).error >= 0)) fault('no error is shown');
}

async function look(story, fault) {
  const { page } = story.main;
  await page.waitForTimeout(600);
  for (const [k, share] of (await inked(page, '.lens:not(.lens-polar) .canvas > canvas:first-child')).entries()) if (share < 0.005) fault(`picture ${k} is empty`);
  const kinds = await page.locator('.lens').first().locator('select').first().locator('option').evaluateAll((list) => list.map(({ value }) => value));
  for (const kind of kinds) {
    await page.locator('.lens').first().locator('select').first().selectOption(kind);
    await page.waitForTimeout(500);
    await until(page, () => document.querySelector('.lens .readout').textContent !== 'The program looks for periods.', null, 20_000).catch(() => {});
    await page.locator('.lens').first().screenshot({ path: path.join(story.out, `lens-${kind}.png`) });
    if (!['polar', 'motion', 'axis-line', 'rotary-map'].includes(kind) && (await inked(page, '.lens:first-child .canvas > canvas:first-child'))[0] < 0.005) fault(`the lens ${kind} is empty`);
  }
  await page.locator('.lens').first().locator('select').first().selectOption('scatter');
  for (const variable of await page.locator('.lens').first().locator('select').nth(1).locator('option').evaluateAll((list) => list.map(({ value }) => value))) {
    await page.locator('.lens').first().locator('select').nth(1).selectOption(variable);
    await page.waitForTimeout(120);
  }
  await page.locator('.lens').first().locator('select').nth(1).selectOption('x');
  await page.waitForTimeout(400);
  await shot(page, story, 'wide');
}

async function brush(story, fault) {
  const { page } = story.main;
  await page.evaluate(() => scrollTo(0, 0));
  await drag(page, 0, [0.3, 0.1], [0.6, 0.55]);
  await page.waitForTimeout(300);
  if (!/^[\d,]+ readings?, mean [+−–\d]/.test(await sentence(page))) fault(`the drawer says "${await sentence(page)}"`);
  const marked = await inked(page, '.lens .above');
  if (marked.filter((share) => share > 0).length < Math.min(3, marked.length)) fault('marked readings do not show in every picture');
  await shot(page, story, 'brushed', false);
  await page.getByRole('button', { name: 'Explain this' }).click();
  await page.locator('.explanation').waitFor();
  await page.getByRole('button', { name: 'Show as a set-up of its own' }).click();
  await page.getByRole('button', { name: 'Show all readings again' }).click();
  await page.keyboard.press('Escape');
  await until(page, () => !document.querySelector('.marked.some'));
}

/** Where nothing that has a name exceeds chance, the error falls in the chapter of what has none. */
async function noSuspect(page) {
  const none = await page.locator('.suspect .row').count() === 0;
  if (none) console.log('  nothing with a name exceeds chance here');
  return none;
}

async function hover(story, fault) {
  const { page } = story.main;
  const rows = page.locator('.suspect .row');
  if (await noSuspect(page)) return undefined;
  for (let k = 0; k < Math.min(5, await rows.count()); k += 1) {
    await rows.nth(k).hover();
    await page.waitForTimeout(250);
  }
  await rows.first().hover();
  await until(page, () => document.querySelector('.suspect.looked-at'), null, 20_000);
  await page.waitForTimeout(200);
  if ((await inked(page, '.lens .above')).every((share) => share === 0)) fault('a suspect is not drawn into the pictures');
  await shot(page, story, 'hovered', false);
  return undefined;
}

async function add(story, fault) {
  const { page } = story.main;
  if (await noSuspect(page)) return;
  const before = await headline(page);
  await page.locator('.suspect .row').first().click();
  await until(page, (old) => document.querySelector('.chip.current')?.dataset.model !== old, before.current);
  await page.waitForTimeout(900);
  const after = await headline(page);
  if (!(after.error < before.error)) fault(`the error does not fall: ${before.error} to ${after.error}`);
  if (!/systematic error/.test(await page.locator('#said').textContent())) fault('no live region says that the error falls');
  await ranked(page);
  await shot(page, story, 'added');
}

async function confirm(story, fault) {
  const { page } = story.main;
  await page.getByRole('button', { name: 'Confirm by a full fit' }).click();
  await page.locator('.progress').waitFor({ timeout: 5000 }).catch(() => fault('no progress is shown'));
  await until(page, () => ['fitted', 'contradicted'].includes(document.querySelector('.headline')?.dataset.standing));
  await ranked(page);
}

async function cancel(story, fault) {
  const { page } = story.main;
  const before = await headline(page);
  await page.getByRole('button', { name: 'Search to the end' }).click();
  const button = page.getByRole('button', { name: 'Cancel' });
  await button.click({ timeout: 20_000 });
  await ranked(page);
  if ((await headline(page)).current !== before.current) fault('a cancelled search leaves another model');
}

async function undoRedo({ main: { page } }, fault) {
  if (!await page.getByRole('button', { name: 'Undo' }).isEnabled()) return;
  const before = await headline(page);
  await page.locator('h1').click();
  await page.keyboard.press('Control+z');
  await until(page, (old) => document.querySelector('.chip.current')?.dataset.model !== old || !document.querySelector('.headline.is-fitted'), before.current, 20_000);
  await ranked(page);
  await page.keyboard.press('Control+Shift+z');
  await until(page, (old) => document.querySelector('.chip.current')?.dataset.model === old, before.current, 20_000);
  await ranked(page);
  let after = await headline(page);
  // Where frames take seconds the number may stand still on its way.
  for (const end = Date.now() + 30_000; after.error !== before.error && Date.now() < end;) after = await headline(page);
  if (after.error !== before.error) fault(`redo leads to ${after.error} (${after.standing}), not to ${before.error} (${before.standing})`);
}

async function branch(story, fault) {
  const { page } = story.main;
  if (await page.locator('.chip').count() < 2) return;
  await page.locator('.chip .model').first().click();
  await until(page, () => document.querySelector('.chip.current')?.dataset.model === '0');
  await ranked(page);
  const chips = await page.locator('.chip').count();
  if (await page.locator('.suspect .row').count() < 2) return;
  await page.locator('.suspect .row').nth(1).click();
  await until(page, (n) => document.querySelectorAll('.chip').length > n, chips);
  await ranked(page);
  await page.locator('.chip:not(.current) .compare').last().click();
  await until(page, () => document.querySelector('.chip.before'));
  if (await page.locator('.chip.branched').count() === 0) fault('a branch does not show as one');
  await page.locator('.drawn-ladder summary').click();
  await page.waitForTimeout(500);
  await shot(page, story, 'branched');
  await page.locator('.drawn-ladder summary').click();
}

async function formula(story, fault) {
  const { page } = story.main;
  const box = page.getByRole('combobox', { name: 'Formula' });
  await box.click();
  await box.pressSequentially('EXX += dir_', { delay: 20 });
  await page.locator('.suggestions li').first().waitFor({ timeout: 10_000 }).catch(() => fault('no word is offered'));
  await page.keyboard.press('Escape');
  await box.fill('EXX += dir_q * 2');
  await page.locator('.problem').waitFor();
  if (!/column \d+/.test(await page.locator('.problem').textContent())) fault('an error of a formula does not say in which column');
  await box.screenshot({ path: path.join(story.out, 'formula-box.png') });
  await shot(page, story, 'formula-wrong');
  await box.fill('EXX += dir_x * (T_column - 20)');
  await page.locator('.result').waitFor();
  await until(page, () => !document.querySelector('.problem'));
  if (!/counted over \d+/.test(await page.locator('.result').textContent())) fault('tries are not counted');
  await page.keyboard.press('Escape');
  await shot(page, story, 'formula-right');
  const chips = await page.locator('.chip').count();
  await page.getByRole('button', { name: 'Add this formula' }).click();
  await until(page, (n) => document.querySelectorAll('.chip').length > n, chips);
  await ranked(page);
  await box.fill('');
}

async function unknown(story, fault) {
  const { page } = story.main;
  await page.locator('.chip .model').first().click();
  await until(page, () => document.querySelector('.chip.current')?.dataset.model === '0');
  await ranked(page);
  await until(page, () => !document.querySelector('.suspects .looking'));
  if (await page.locator('.unknown').count() === 0) return console.log('  nothing without a name stands out here');
  const before = await headline(page);
  await page.locator('.unknown button.primary').first().click();
  await page.locator('.surface-drawn button.primary, .banner.bad').first().waitFor({ timeout: kLong });
  if (await page.locator('.banner.bad').count() > 0) {
    console.log(`  ${await page.locator('.banner.bad').first().textContent()}`);
    return page.locator('.banner.bad button').first().click();
  }
  await page.waitForTimeout(1200);
  await shot(page, story, 'surface');
  await page.locator('.surface-drawn button.primary').first().click();
  await until(page, (old) => document.querySelector('.chip.current')?.dataset.model !== old, before.current);
  await page.waitForTimeout(900);
  // Noise that has swallowed the effect shows an error of nothing; the full fit with it tells that of the model before.
  await until(page, () => ['fitted', 'contradicted'].includes(document.querySelector('.headline')?.dataset.standing));
  const after = await headline(page);
  const at = (model) => page.locator(`.chip[data-model="${model}"] .model`).click();
  await at(before.current);
  await until(page, (model) => document.querySelector('.chip.current')?.dataset.model === model, before.current);
  const given = await headline(page);
  await at(after.current);
  await until(page, (model) => document.querySelector('.chip.current')?.dataset.model === model, after.current);
  if (!(after.error < given.error)) fault(`the surface does not lower the error: ${given.error} to ${after.error}`);
  await ranked(page);
  return undefined;
}

async function leaveOut({ main: { page } }, fault) {
  await page.evaluate(() => scrollTo(0, 0));
  const chips = await page.locator('.chip').count();
  await drag(page, 0, [0.2, 0.12], [0.32, 0.3]);
  await page.getByRole('button', { name: 'Leave out …' }).click();
  await page.getByLabel('Why?').fill('cable moved');
  await page.getByRole('button', { name: 'Leave them out' }).click();
  await until(page, (n) => document.querySelectorAll('.chip').length > n, chips);
  await ranked(page);
  if (!/left out/.test(await page.locator('.notes').textContent())) fault('readings that are left out are not named');
}

async function takeAlong(story, fault) {
  const { page } = story.main;
  for (const what of ['model file', 'commands as a script']) {
    const files = await page.locator('.exports li').count();
    await page.getByRole('button', { name: `Write the ${what}` }).click();
    await until(page, (n) => document.querySelectorAll('.exports li').length > n, files);
    await idle(page);
  }
  await page.getByRole('button', { name: 'Copy' }).click();
  if (!/add |fit/.test(await page.locator('.commands').textContent())) fault('the commands of the session are not shown');
  await shot(page, story, 'end');
}

async function times({ main: { page } }) {
  const entries = await page.evaluate(() => performance.getEntriesByType('measure').filter(({ name }) => name.startsWith('volcal:')).map(({ name, duration }) => [name, duration]));
  const names = [...new Set(entries.map(([name]) => name))];
  for (const name of names) {
    const list = entries.filter(([each]) => each === name).map(([, duration]) => duration).sort((a, b) => a - b);
    const at = (share) => list[Math.min(list.length - 1, Math.floor(share * list.length))].toFixed(0);
    console.log(`  ${name}: median ${at(0.5)} ms, 95 % ${at(0.95)} ms, of ${list.length}`);
  }
}

export const steps = [['load', load], ['look', look], ['brush', brush], ['hover', hover], ['add', add], ['confirm', confirm], ['cancel', cancel], ['undo and redo', undoRedo], ['branch', branch], ['formula', formula], ['unknown', unknown], ['leave out', leaveOut], ['export', takeAlong], ['times', times]];
