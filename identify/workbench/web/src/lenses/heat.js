// Means over two variables, as a map.
import { fixed, significant } from '../../../../report/web/src/dom.js';
import { axisBelow, axisLeft, frame, text } from '../draw/axes.js';
import { alpha, channels, hex, kMarked } from '../draw/palette.js';
import { linear } from '../draw/scale.js';
import { meansInBins } from '../data/statistics.js';
import { titleOf } from '../data/variables.js';
import { abscissa } from './abscissa.js';
import { namesOf, unitOf, valuesOf } from './values.js';

const kMostBins = 40;
const kBar = 54;

/** Coarser bins where a place would hold a reading or two. */
const binsFor = (length) => Math.min(kMostBins, Math.max(8, Math.round(Math.sqrt(length / 8))));

function side(axis, bins) {
  if (axis.steps) return { ...axis, edges: [...axis.centres.map((c) => c - axis.gap / 2), axis.centres.at(-1) + axis.gap / 2] };
  const [low, high] = [axis.centres[0] - axis.gap / 2, axis.centres.at(-1) + axis.gap / 2];
  const factor = bins / axis.bins;
  const index = axis.index.map((k) => (k < 0 ? -1 : Math.min(bins - 1, Math.floor(k * factor))));
  return { ...axis, bins, index, edges: Array.from({ length: bins + 1 }, (_, k) => low + (k * (high - low)) / bins) };
}

function cellsOf(x, y) {
  const index = new Int16Array(x.index.length);
  for (let i = 0; i < index.length; i += 1) index[i] = x.index[i] < 0 || y.index[i] < 0 ? -1 : y.index[i] * x.bins + x.index[i];
  return index;
}

function limitOf(means) {
  const sizes = Array.from(means.mean, Math.abs).filter((v, k) => Number.isFinite(v) && means.count[k] > 1).sort((a, b) => a - b);
  return sizes[Math.floor(0.97 * (sizes.length - 1))] || 1e-9;
}

function prepare(view, config, size) {
  const [ax, ay] = [abscissa(view, config.x), abscissa(view, config.y)];
  if (!ax || !ay) return null;
  const bins = binsFor(view.length);
  const [x, y] = [side(ax, Math.min(bins, ax.bins)), side(ay, Math.min(bins, ay.bins))];
  const box = { left: 58, right: size.width - 12 - kBar, top: 8, bottom: size.height - 38 };
  const index = cellsOf(x, y);
  const means = (residual, mask = view.shown) => {
    const { values, weight } = valuesOf(view, config, residual);
    return meansInBins(index, x.bins * y.bins, values, null, { mask, weight });
  };
  const shownResidual = config.when === 'before' && view.before ? view.before : view.now;
  const now = means(shownResidual);
  const limit = Math.max(...[view.before ? means(view.before) : now, now].map(limitOf));
  return {
    view, config, box, x, y, index, means, now, limit,
    sx: linear(x.edges[0], x.edges.at(-1), box.left, box.right), sy: linear(y.edges[0], y.edges.at(-1), box.bottom, box.top),
  };
}

const mix = (from, to, t) => from.map((v, k) => Math.round(v + (to[k] - v) * t));

const kShades = 128; // on either side of zero

/** Of a value by its size against a limit: one hue below zero, another above, the page at zero. */
function shades() {
  const [page, below, above] = ['page', 'series-0', 'bad'].map((name) => channels(hex(name)));
  const list = Array.from({ length: 2 * kShades + 1 }, (_, k) => `rgb(${mix(page, k < kShades ? below : above, Math.abs(k / kShades - 1)).join(',')})`);
  return (value, limit) => list[Math.round(kShades * (1 + Math.max(-1, Math.min(1, value / limit))))];
}

function drawCells(ctx, { x, y, sx, sy, limit }, means) {
  const shadeOf = shades();
  for (let j = 0; j < y.bins; j += 1) {
    for (let i = 0; i < x.bins; i += 1) {
      const value = means.mean[j * x.bins + i];
      if (!Number.isFinite(value)) continue;
      ctx.fillStyle = shadeOf(value, limit);
      const [left, top] = [Math.floor(sx(x.edges[i])), Math.floor(sy(y.edges[j + 1]))];
      ctx.fillRect(left, top, Math.ceil(sx(x.edges[i + 1])) - left, Math.ceil(sy(y.edges[j])) - top);
    }
  }
}

function drawBar(ctx, { box, limit, view, config }) {
  const left = box.right + 12;
  const height = box.bottom - box.top;
  const shadeOf = shades();
  for (let k = 0; k < height; k += 1) {
    ctx.fillStyle = shadeOf(1 - (2 * k) / height, 1);
    ctx.fillRect(left, box.top + k, 10, 1.5);
  }
  const words = fixed(limit, limit < 1 ? 2 : 1);
  text(ctx, `+${words}`, left + 14, box.top + 9);
  text(ctx, '0', left + 14, (box.top + box.bottom) / 2 + 4);
  text(ctx, `−${words}`, left + 14, box.bottom);
  text(ctx, unitOf(view, config), left, box.bottom + 15);
}

/** Places without readings are not zero. */
function empty(ctx, { box }) {
  ctx.fillStyle = hex('grid');
  ctx.fillRect(box.left, box.top, box.right - box.left, box.bottom - box.top);
}

function drawBase(ctx, scene) {
  empty(ctx, scene);
  axisBelow(ctx, scene.box, scene.sx, titleOf(scene.x.variable), { steps: scene.x.steps });
  axisLeft(ctx, scene.box, scene.sy, titleOf(scene.y.variable), 5, scene.y.steps);
  drawCells(ctx, scene, scene.now);
  frame(ctx, scene.box);
  drawBar(ctx, scene);
}

/** What is looked at replaces the map; marked readings are outlined where they lie. */
function drawOverlay(ctx, scene, { selection, preview }) {
  const { box, view } = scene;
  if (preview && preview.residual.length === view.length) {
    empty(ctx, scene);
    drawCells(ctx, scene, scene.means(preview.residual));
    frame(ctx, box);
    text(ctx, '~ with it in the model', box.left + 6, box.top + 14, { name: 'warning' });
  }
  if (selection.mask) outlineMarked(ctx, scene, selection.mask);
}

function outlineMarked(ctx, { x, y, sx, sy, index }, mask) {
  const hit = new Uint8Array(x.bins * y.bins);
  for (let i = 0; i < index.length; i += 1) if (mask[i] && index[i] >= 0) hit[index[i]] = 1;
  ctx.strokeStyle = hex(kMarked);
  ctx.fillStyle = alpha(kMarked, 0.2);
  ctx.lineWidth = 1.2;
  for (let k = 0; k < hit.length; k += 1) {
    if (!hit[k]) continue;
    const [i, j] = [k % x.bins, Math.floor(k / x.bins)];
    const [left, top] = [sx(x.edges[i]), sy(y.edges[j + 1])];
    ctx.fillRect(left, top, sx(x.edges[i + 1]) - left, sy(y.edges[j]) - top);
    ctx.strokeRect(left + 0.5, top + 0.5, sx(x.edges[i + 1]) - left - 1, sy(y.edges[j]) - top - 1);
  }
}

function brush({ x, y, sx, sy }, { x0, x1, y0, y1 }) {
  const [left, right, low, high] = [sx.invert(x0), sx.invert(x1), sy.invert(y1), sy.invert(y0)];
  const [u, v] = [x.values, y.values];
  return (i) => u[i] >= left && u[i] <= right && v[i] >= low && v[i] <= high;
}

const cellAt = (edges, value) => edges.findIndex((edge, k) => k + 1 < edges.length && value >= edge && value < edges[k + 1]);

function readout({ x, y, sx, sy, now, view, config }, px, py) {
  const [i, j] = [cellAt(x.edges, sx.invert(px)), cellAt(y.edges, sy.invert(py))];
  const k = j * x.bins + i;
  if (i < 0 || j < 0 || !Number.isFinite(now.mean[k])) return null;
  return `${x.variable.label} ${significant(x.centres.length === x.bins ? x.centres[i] : (x.edges[i] + x.edges[i + 1]) / 2, 4)}, ${y.variable.label} ${significant((y.edges[j] + y.edges[j + 1]) / 2, 4)}: mean ${fixed(now.mean[k], 2)} ± ${significant(2 * now.u[k], 2)} ${unitOf(view, config)}, ${now.count[k]} readings`;
}

export const heat = {
  kind: 'heat', title: 'map over', controls: ['x', 'y', 'of', 'perSigma', 'when'], needs: (config) => [config.x, config.y, ...namesOf(config)],
  prepare, drawBase, drawOverlay, brush, readout, brushBox: ({ box }) => box,
};
