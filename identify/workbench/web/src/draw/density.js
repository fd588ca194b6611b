// Readings as dots where they are few, as density where they are many.
import { alpha, channels, hex } from './palette.js';

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

/** How many readings lie in every pixel. */
function countPixels({ column, row, w, h }, mask = null) {
  const counts = new Uint16Array(w * h);
  let largest = 0;
  for (let i = 0; i < column.length; i += 1) {
    if (column[i] < 0 || (mask && !mask[i])) continue;
    const at = row[i] * w + column[i];
    const count = (counts[at] += 1);
    if (count > largest) largest = count;
  }
  return { counts, largest };
}

let scratch = null;

function scratchOf(w, h) {
  scratch ??= document.createElement('canvas');
  scratch.width = Math.max(1, w);
  scratch.height = Math.max(1, h);
  return scratch;
}

/** Draws density in the shade of `name`: stronger where more readings lie. */
function drawDensity(ctx, box, where, name, { mask = null, floor = 0.28 } = {}) {
  const { w, h } = where;
  if (w < 1 || h < 1) return;
  const { counts, largest } = countPixels(where, mask);
  if (largest === 0) return;
  const canvas = scratchOf(w, h);
  const context = canvas.getContext('2d', { willReadFrequently: true });
  const image = context.createImageData(w, h);
  const pixels = new Uint32Array(image.data.buffer);
  const [r, g, b] = channels(hex(name));
  const rgb = (b << 16) | (g << 8) | r;
  const strength = new Uint8Array(largest + 1);
  for (let k = 1; k <= largest; k += 1) strength[k] = 255 * (floor + (1 - floor) * (Math.log(k) / Math.log(largest + 1)));
  for (let k = 0; k < pixels.length; k += 1) if (counts[k] > 0) pixels[k] = ((strength[counts[k]] << 24) | rgb) >>> 0;
  context.putImageData(image, 0, 0);
  ctx.drawImage(canvas, box.left, box.top);
}

/** Draws dots of `size` pixels in one path. */
function drawDots(ctx, box, { column, row }, name, { mask = null, opacity = 0.45, size = 3 } = {}) {
  ctx.fillStyle = alpha(name, opacity);
  const off = (size - 1) / 2;
  for (let i = 0; i < column.length; i += 1) {
    if (column[i] < 0 || (mask && !mask[i])) continue;
    ctx.fillRect(box.left + column[i] - off, box.top + row[i] - off, size, size);
  }
}

export function drawReadings(ctx, box, where, name, options = {}) {
  if (where.column.length > kMostDots) drawDensity(ctx, box, where, name, options);
  else drawDots(ctx, box, where, name, options);
}
