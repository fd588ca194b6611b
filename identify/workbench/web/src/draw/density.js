// Readings as dots where they are few, as density where they are many.
import { countPixels } from '../data/statistics.js';
import { channels, hex } from './palette.js';

const kMostDots = 20000;

/** Places in pixels of a box: [column, row] of every reading, -1 outside. `shown` chooses. */
export function places(x, y, box, sx, sy, shown, shift = null) {
  const n = x.length;
  const column = new Int16Array(n);
  const row = new Int16Array(n);
  const w = Math.round(box.right - box.left);
  const h = Math.round(box.bottom - box.top);
  const kx = (sx.to - sx.from) / (sx.high - sx.low || 1);
  const ky = (sy.to - sy.from) / (sy.high - sy.low || 1);
  const [ox, oy] = [sx.from - sx.low * kx - box.left, sy.from - sy.low * ky - box.top];
  for (let i = 0; i < n; i += 1) {
    const px = ox + (shift ? x[i] + shift[i] : x[i]) * kx;
    const py = oy + y[i] * ky;
    if ((shown && !shown[i]) || !(px >= 0 && px < w && py >= 0 && py < h)) {
      column[i] = -1;
      continue;
    }
    column[i] = px;
    row[i] = py;
  }
  return { column, row, w, h };
}

let scratch = null;

function scratchOf(w, h) {
  scratch ??= document.createElement('canvas');
  scratch.width = Math.max(1, w);
  scratch.height = Math.max(1, h);
  return scratch;
}

/** In the shade of `name`, `strength(k, largest)` 0..1 where k readings cover a pixel: one image, however many. */
function drawCounts(ctx, box, where, name, { size, edge, mask, strength }) {
  if (where.w < 1 || where.h < 1) return;
  const { counts, largest, width, height } = countPixels(where, size, edge, mask);
  if (largest === 0) return;
  const canvas = scratchOf(width, height);
  const context = canvas.getContext('2d', { willReadFrequently: true });
  const image = context.createImageData(width, height);
  const pixels = new Uint32Array(image.data.buffer);
  const [r, g, b] = channels(hex(name));
  const rgb = (b << 16) | (g << 8) | r;
  const shades = Uint32Array.from({ length: largest + 1 }, (_, k) => (k === 0 ? 0 : ((Math.round(255 * strength(k, largest)) << 24) | rgb) >>> 0));
  for (let k = 0; k < pixels.length; k += 1) if (counts[k] > 0) pixels[k] = shades[counts[k]];
  context.putImageData(image, 0, 0);
  ctx.save();
  ctx.imageSmoothingEnabled = false;
  ctx.drawImage(canvas, box.left - edge, box.top - edge);
  ctx.restore();
}

/** Density: stronger where more readings lie. */
function drawDensity(ctx, box, where, name, { mask = null, floor = 0.28 } = {}) {
  const strength = (k, largest) => floor + (1 - floor) * (Math.log(k) / Math.log(largest + 1));
  drawCounts(ctx, box, where, name, { size: 1, edge: 0, mask, strength });
}

/** Dots of `size` pixels, translucent: several over each other are stronger. */
function drawDots(ctx, box, where, name, { mask = null, opacity = 0.45, size = 3 } = {}) {
  drawCounts(ctx, box, where, name, { size, edge: size, mask, strength: (k) => 1 - (1 - opacity) ** k });
}

export function drawReadings(ctx, box, where, name, options = {}) {
  if (where.column.length > kMostDots) drawDensity(ctx, box, where, name, options);
  else drawDots(ctx, box, where, name, options);
}
