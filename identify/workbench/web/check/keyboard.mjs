// The keyboard alone: every control is reached, shows that it is, and does what a click does.
import { headline, ranked, shot, until } from './steps.mjs';

const kMostTabs = 160;

const focused = (page) => page.evaluate(() => {
  const node = document.activeElement;
  const style = getComputedStyle(node);
  return { tag: node.tagName, classes: node.className, name: node.getAttribute('aria-label') ?? node.textContent.trim().slice(0, 40), outlined: style.outlineStyle !== 'none' && parseFloat(style.outlineWidth) > 0 };
});

async function tabTo(page, wanted, seen) {
  for (let k = 0; k < kMostTabs; k += 1) {
    await page.keyboard.press('Tab');
    const at = await focused(page);
    seen.push(at);
    if (wanted(at)) return true;
  }
  return false;
}

/** To a control by its name, and Enter. */
async function press(page, name, seen) {
  const found = await tabTo(page, (at) => name.test(at.name ?? ''), seen);
  if (found) await page.keyboard.press('Enter');
  return found;
}

const current = (page) => page.evaluate(() => document.querySelector('.chip.current')?.dataset.model);
const another = (page, old) => until(page, (former) => document.querySelector('.chip.current')?.dataset.model !== former, old);

async function confirmUndoAndTry({ main: { page } }, fault, seen) {
  if (!await press(page, /^Confirm by a full fit/, seen)) return fault('the full fit is not reached');
  await until(page, () => ['fitted', 'contradicted'].includes(document.querySelector('.headline')?.dataset.standing));
  await ranked(page);
  const confirmed = await current(page);
  await page.keyboard.press('Control+z');
  await another(page, confirmed);
  await ranked(page);
  await page.keyboard.press('Control+Shift+z');
  await until(page, (old) => document.querySelector('.chip.current')?.dataset.model === old, confirmed);
  await ranked(page);
  if (!await tabTo(page, ({ name, tag }) => tag === 'INPUT' && name === 'Formula', seen)) return fault('the formula is not reached');
  await page.keyboard.type('EYY += dir_y * (x - 10)');
  await page.locator('.result').waitFor();
  await page.keyboard.press('Escape');
  if (!await press(page, /^Add this formula/, seen)) return fault('a formula cannot be added');
  await another(page, confirmed);
  await ranked(page);
  return undefined;
}

/** What has no name, where there is something, and what is taken along. */
async function drawAndExport({ main: { page } }, fault, seen) {
  await page.locator('.chip .model').first().focus();
  await page.keyboard.press('Enter');
  await until(page, () => document.querySelector('.chip.current')?.dataset.model === '0');
  await ranked(page);
  await until(page, () => !document.querySelector('.suspects .looking'));
  if (await page.locator('.unknown').count() > 0) {
    const drawn = await page.locator('.surface-drawn').count() > 0 || await press(page, /^Draw the /, seen);
    if (!drawn) return fault('what has no name cannot be drawn');
    await page.locator('.surface-drawn button.primary, .banner.bad').first().waitFor({ timeout: 180_000 });
    if (await page.locator('.surface-drawn').count() > 0) {
      if (!await press(page, /^Add the (surface|curve)/, seen)) return fault('a surface cannot be added');
      await another(page, '0');
      await ranked(page);
    }
  }
  const files = await page.locator('.exports li').count();
  if (!await press(page, /^Write the commands/, seen)) return fault('the export is not reached');
  await until(page, (n) => document.querySelectorAll('.exports li').length > n, files);
  return undefined;
}

export async function aloneWithKeys(story, fault) {
  const { page } = story.main;
  await page.evaluate(() => { scrollTo(0, 0); document.activeElement?.blur(); });
  await page.locator('.chip .model').first().focus();
  await page.keyboard.press('Enter');
  await until(page, () => document.querySelector('.chip.current')?.dataset.model === '0');
  await ranked(page);
  await page.evaluate(() => document.activeElement?.blur());
  const seen = [];
  if (!await tabTo(page, ({ tag, classes }) => tag === 'CANVAS' && classes.includes('above'), seen)) return fault('no picture is reached');
  for (const key of ['ArrowRight', 'ArrowRight', 'Shift+ArrowRight']) await page.keyboard.press(key);
  await page.waitForTimeout(200);
  if (!/readings?, mean/.test(await page.locator('.marked .sentence').textContent())) fault('arrow keys do not mark readings');
  await page.keyboard.press('Escape');
  if (await page.locator('.suspect .add').count() === 0) return;
  if (!await tabTo(page, ({ classes }) => classes === 'add', seen)) return fault('no suspect is reached');
  await until(page, () => document.querySelector('.suspect.looked-at'), null, 20_000).catch(() => fault('a suspect that is reached is not drawn'));
  await shot(page, story, 'keyboard', false);
  const before = await headline(page);
  await page.keyboard.press('Enter');
  await until(page, (old) => document.querySelector('.chip.current')?.dataset.model !== old, before.current);
  await ranked(page);
  await confirmUndoAndTry(story, fault, seen);
  await drawAndExport(story, fault, seen);
  const bare = seen.filter(({ outlined, tag }) => !outlined && tag !== 'BODY');
  if (bare.length > 0) fault(`${bare.length} controls do not show that they are reached, as ${bare[0].tag} "${bare[0].name}"`);
  return undefined;
}
