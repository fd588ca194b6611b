// Frames, grids, ticks and titles of a picture.
import { fixed } from '../../../../report/web/src/dom.js';
import { hex } from './palette.js';
import { niceTicks } from './scale.js';

const kFont = '11px system-ui, sans-serif';

export function line(ctx, x0, y0, x1, y1, name, width = 1) {
  ctx.strokeStyle = hex(name);
  ctx.lineWidth = width;
  ctx.beginPath();
  ctx.moveTo(x0, y0);
  ctx.lineTo(x1, y1);
  ctx.stroke();
}

const crisp = (v) => Math.round(v) + 0.5;

export function text(ctx, words, x, y, { align = 'left', base = 'alphabetic', name = 'muted', font = kFont, turn = 0 } = {}) {
  ctx.save();
  Object.assign(ctx, { fillStyle: hex(name), font, textAlign: align, textBaseline: base });
  ctx.translate(x, y);
  ctx.rotate(turn);
  ctx.fillText(words, 0, 0);
  ctx.restore();
}

/** Grid and numbers at the left of a box; a line at zero. */
export function axisLeft(ctx, box, scale, title, most = 5, steps = null) {
  if (steps) namesLeft(ctx, box, scale, steps);
  else numbersLeft(ctx, box, scale, most);
  if (title) text(ctx, title, 11, (box.top + box.bottom) / 2, { align: 'center', base: 'middle', turn: -Math.PI / 2 });
  frame(ctx, box);
}

function namesLeft(ctx, box, scale, steps) {
  const every = Math.max(1, Math.ceil((14 * steps.at.length) / Math.max(1, box.bottom - box.top)));
  steps.at.forEach((value, k) => {
    if (k % every !== 0) return;
    const word = String(steps.text[k]);
    text(ctx, word.length > 8 ? `${word.slice(0, 7)}…` : word, box.left - 5, scale(value), { align: 'right', base: 'middle', font: '10px system-ui, sans-serif' });
  });
}

function numbersLeft(ctx, box, scale, most) {
  const { at, decimals } = niceTicks(scale.low, scale.high, most);
  for (const value of at) {
    const y = crisp(scale(value));
    line(ctx, box.left, y, box.right, y, Math.abs(value) < 1e-12 ? 'zero' : 'grid');
    text(ctx, fixed(value, decimals), box.left - 6, y, { align: 'right', base: 'middle' });
  }
}

export function frame(ctx, box) {
  ctx.strokeStyle = hex('rule');
  ctx.lineWidth = 1;
  ctx.strokeRect(crisp(box.left), crisp(box.top), Math.round(box.right - box.left), Math.round(box.bottom - box.top));
}

function stepTicks(ctx, box, scale, steps, labels) {
  const room = (box.right - box.left) / Math.max(1, steps.at.length);
  const every = Math.max(1, Math.ceil(26 / Math.max(1, room)));
  steps.at.forEach((value, k) => {
    if (k % every !== 0) return;
    const x = scale(value);
    line(ctx, crisp(x), box.bottom, crisp(x), box.bottom + 4, 'rule');
    if (!labels) return;
    const words = String(steps.text[k]);
    const shown = room * every < 7 * words.length ? `${words.slice(0, Math.max(2, Math.floor((room * every) / 6.5)))}…` : words;
    text(ctx, shown, x, box.bottom + 15, { align: 'center' });
  });
}

/** Grid and numbers below a box; `steps` for a variable of a few values. */
export function axisBelow(ctx, box, scale, title, { steps = null, labels = true, most = null } = {}) {
  if (steps) stepTicks(ctx, box, scale, steps, labels);
  else {
    const { at, decimals } = niceTicks(scale.low, scale.high, most ?? Math.max(3, Math.round((box.right - box.left) / 75)));
    for (const value of at) {
      const x = crisp(scale(value));
      line(ctx, x, box.top, x, box.bottom, 'grid');
      if (labels) text(ctx, fixed(value, decimals), x, box.bottom + 15, { align: 'center' });
    }
  }
  if (labels && title) text(ctx, title, (box.left + box.right) / 2, box.bottom + 30, { align: 'center' });
}
