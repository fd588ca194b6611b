// Colours of the pictures, read from the style sheet once for every theme.
import { color, onThemeChange } from '../../../../report/web/src/theme.js';

const read = new Map();
onThemeChange(() => read.clear());
addEventListener('beforeprint', () => read.clear());

export function hex(name) {
  if (!read.has(name)) read.set(name, color(name));
  return read.get(name);
}

export const channels = (value) => [16, 8, 0].map((shift) => (Number.parseInt(value.slice(1), 16) >> shift) & 255);
export const alpha = (name, a) => `rgba(${channels(hex(name)).join(',')},${a})`;

/** What stands for what, in every picture. */
export const kNow = 'series-0';
export const kBefore = 'muted';
export const kPreview = 'warning';
export const kMarked = 'series-3';
