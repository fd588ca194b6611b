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
  const bare = seen.filter(({ outlined, tag }) => !outlined && tag !== 'BODY');
  if (bare.length > 0) fault(`${bare.length} controls do not show that they are reached, as ${bare[0].tag} "${bare[0].name}"`);
  return undefined;
}
