// Colours of plots follow the page's style sheet, light or dark; on paper always light.
import { el } from './dom.js';

const root = document.documentElement;
const system = matchMedia('(prefers-color-scheme: dark)');
const listeners = [];

/** `listener` is called after the colours have changed, until the function returned is called. */
export function onThemeChange(listener) {
  listeners.push(listener);
  return () => { listeners.splice(listeners.indexOf(listener), 1); };
}

function setTheme(theme) {
  if (root.dataset.theme === theme) return;
  root.dataset.theme = theme;
  [...listeners].forEach((listener) => listener());
}

const systemTheme = () => (system.matches ? 'dark' : 'light');
setTheme(systemTheme());
system.addEventListener('change', () => setTheme(systemTheme()));

/** Value of a custom property of the style sheet, e.g. color('axis-X'). */
export const color = (name) => getComputedStyle(root).getPropertyValue(`--${name}`).trim();

const channels = (hex) => [16, 8, 0].map((shift) => (Number.parseInt(hex.slice(1), 16) >> shift) & 255);

/** Relative luminance of sRGB, WCAG 2. */
const luminance = (rgb) => rgb.map((v) => v / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
  .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);

/** Style of a cell in a shade over the page, its text black or white, whichever is read better. */
export function shaded(hex, alpha) {
  const page = channels(color('page'));
  const light = luminance(channels(hex).map((v, i) => alpha * v + (1 - alpha) * page[i]));
  return `background:${transparent(hex, alpha)};color:${light > 0.179 ? '#000000' : '#ffffff'}`;
}

export function transparent(hex, alpha) {
  const value = Number.parseInt(hex.slice(1), 16);
  return `rgba(${value >> 16}, ${(value >> 8) & 255}, ${value & 255}, ${alpha})`;
}

/** Colours for things that are neither axes nor verdicts: instruments, tools, sources. */
export const series = (index) => color(`series-${index % kSeries}`);

const otherTheme = () => (root.dataset.theme === 'dark' ? 'light' : 'dark');

export const toggleTheme = () => setTheme(otherTheme());

/** Button that switches between light and dark. */
export function themeSwitch() {
  const button = el('button', { type: 'button', onclick: toggleTheme });
  const label = () => { button.textContent = `${otherTheme()} background`; };
  onThemeChange(label);
  label();
  return button;
}

const kInstruments = ['laser-tracer', 'ball-bar', 'displacement', 'straightness', 'angle', 'laser-tracker', 'volumetric-points', 'r-test', 'probed-sphere'];
const kSeries = 10;

/** Index of the colour of an instrument: the same in every section and in every report. */
export function instrumentIndex(instrument) {
  if (!kInstruments.includes(instrument)) kInstruments.push(instrument);
  return kInstruments.indexOf(instrument) % kSeries;
}

/** Name of an instrument behind a dot of its colour. */
export const instrumentMark = (instrument) => el('span', { class: 'key' }, [el('i', { class: `dot series-${instrumentIndex(instrument)}` }), instrument]);

/** Before printing the page turns light and as wide as the paper, then `redraw(true)` is called; afterwards it turns back. */
export function onPrint(redraw) {
  let shown;
  const turn = (printing) => {
    if (printing) shown = root.dataset.theme;
    root.classList.toggle('printing', printing);
    setTheme(printing ? 'light' : shown);
    redraw(printing);
  };
  addEventListener('beforeprint', () => turn(true));
  addEventListener('afterprint', () => turn(false));
}
