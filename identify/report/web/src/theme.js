// Colours of plots follow the page's style sheet, light or dark; on paper always light.
import { el } from './dom.js';

const root = document.documentElement;
const system = matchMedia('(prefers-color-scheme: dark)');
const listeners = [];

/** `listener` is called after the colours have changed. */
export const onThemeChange = (listener) => listeners.push(listener);

function setTheme(theme) {
  if (root.dataset.theme === theme) return;
  root.dataset.theme = theme;
  listeners.forEach((listener) => listener());
}

const systemTheme = () => (system.matches ? 'dark' : 'light');
setTheme(systemTheme());
system.addEventListener('change', () => setTheme(systemTheme()));

/** Value of a custom property of the style sheet, e.g. color('axis-X'). */
export const color = (name) => getComputedStyle(root).getPropertyValue(`--${name}`).trim();

export function transparent(hex, alpha) {
  const value = Number.parseInt(hex.slice(1), 16);
  return `rgba(${value >> 16}, ${(value >> 8) & 255}, ${value & 255}, ${alpha})`;
}

/** Colours for things that are neither axes nor verdicts: instruments. Colour-blind safe. */
export const series = (index) => color(`series-${index % 7}`);

/** Button that switches between light and dark. */
export function themeSwitch() {
  const other = () => (root.dataset.theme === 'dark' ? 'light' : 'dark');
  const button = el('button', { type: 'button', onclick: () => setTheme(other()) });
  const label = () => { button.textContent = `${other()} background`; };
  onThemeChange(label);
  label();
  return button;
}

/** Before printing the page turns light and as wide as the paper, then `redraw` is called; afterwards it turns back. */
export function onPrint(redraw) {
  let shown;
  const turn = (printing) => {
    if (printing) shown = root.dataset.theme;
    root.classList.toggle('printing', printing);
    setTheme(printing ? 'light' : shown);
    redraw();
  };
  addEventListener('beforeprint', () => turn(true));
  addEventListener('afterprint', () => turn(false));
}
