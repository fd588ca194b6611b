// Displacement of the functional point that the residuals ask for, cell by cell of the measured volume, in space.
import { fixed, significant } from '../../../../report/web/src/dom.js';
import { rangeOf } from '../data/statistics.js';
import { directionsOf } from '../data/variables.js';
import { line, text } from '../draw/axes.js';
import { alpha, hex, kBefore, kMarked, kNow, kPreview } from '../draw/palette.js';
import { cellVectors, gridOf } from './vector_cells.js';

const kReach = 0.15; // of the extent, for the longest vector

const corner = (view, low, high) => [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]]);
const kEdges = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/** Parallel projection: turned about the vertical, then tilted. */
function projection({ turn = -0.6, tilt = 0.45 }, low, high, box) {
  const centre = low.map((v, k) => (v + high[k]) / 2);
  const extent = Math.hypot(...low.map((v, k) => high[k] - v)) || 1;
  const scale = (0.92 * Math.min(box.right - box.left, 1.2 * (box.bottom - box.top))) / extent;
  const [cx, cy] = [(box.left + box.right) / 2, (box.top + box.bottom) / 2];
  const [ct, st, cp, sp] = [Math.cos(turn), Math.sin(turn), Math.cos(tilt), Math.sin(tilt)];
  const project = (p) => {
    const [x, y, z] = p.map((v, k) => v - centre[k]);
    const [u, v] = [ct * x - st * y, st * x + ct * y];
    return [cx + scale * u, cy - scale * (cp * z + sp * v)];
  };
  /** Places of all readings in the picture. */
  const projectAll = ([px, py, pz]) => {
    const [left, top] = [new Float32Array(px.length), new Float32Array(px.length)];
    for (let i = 0; i < px.length; i += 1) {
      const x = px[i] - centre[0];
      const y = py[i] - centre[1];
      left[i] = cx + scale * (ct * x - st * y);
      top[i] = cy - scale * (cp * (pz[i] - centre[2]) + sp * (st * x + ct * y));
    }
    return { left, top };
  };
  return { project, projectAll };
}

function splits(view, config) {
  const values = config.split ? view.column(config.split) : null;
  if (!values) return [{ mask: view.shown, name: kNow, words: null }];
  const axis = config.split.replace(/^dir_/, '').toUpperCase();
  return [[1, 'bad', `${axis} towards +`], [-1, kNow, `${axis} towards −`]].map(([sign, name, words]) => ({
    mask: view.shown.map((on, i) => (on && values[i] === sign ? 1 : 0)), name, words,
  }));
}

function prepare(view, config, size) {
  const points = ['point_x', 'point_y', 'point_z'].map(view.column);
  const along = ['along_x', 'along_y', 'along_z'].map(view.column);
  if ([...points, ...along].some((each) => !each)) return null;
  const ranges = points.map((values) => rangeOf(values, view.shown));
  if (ranges.some((range) => !range)) return { empty: 'No reading that is shown has a place in the volume.' };
  const [low, high] = [ranges.map(([a]) => a), ranges.map(([, b]) => b)];
  const box = { left: 8, right: size.width - 8, top: 8, bottom: size.height - 26 };
  const grid = gridOf(points, low, high, view.length);
  const of = (residual, mask) => cellVectors(grid, residual, along, view.sigma, mask);
  const parts = splits(view, config).map((part) => ({ ...part, now: of(view.now, part.mask), before: view.before ? of(view.before, part.mask) : null }));
  const sizes = parts.flatMap(({ now, before }) => [now, before]).filter(Boolean).flatMap((cells) => cells.map(({ vector }) => Math.hypot(...vector))).sort((a, b) => a - b);
  const largest = sizes[Math.floor(0.98 * (sizes.length - 1))] || 1e-9;
  const extent = Math.max(...low.map((v, k) => high[k] - v), 1);
  return { view, config, box, grid, of, parts, low, high, points, magnification: (kReach * extent) / largest, ...projection(config, low, high, box) };
}

/** Where the readings lie in the picture, computed when it is first asked for. */
function placesOf(scene) {
  scene.places ??= scene.projectAll(scene.points);
  return scene.places;
}

function drawVolume(ctx, { project, low, high, view }) {
  const corners = corner(view, low, high).map(project);
  for (const [a, b] of kEdges) line(ctx, ...corners[a], ...corners[b], 'rule');
  [['x', 1], ['y', 2], ['z', 4]].forEach(([axis, end]) => {
    const [from, to] = [corners[0], corners[end]];
    text(ctx, `${axis.toUpperCase()} +`, to[0] + 0.06 * (to[0] - from[0]), to[1] + 0.06 * (to[1] - from[1]), { align: 'center', base: 'middle', name: `axis-${axis.toUpperCase()}`, font: '600 12px system-ui, sans-serif' });
  });
}

function drawCells(ctx, { project, magnification }, cells, name, { width = 1.8, opacity = 1, dash = [] } = {}) {
  ctx.save();
  ctx.strokeStyle = alpha(name, opacity);
  ctx.fillStyle = alpha(name, opacity);
  ctx.lineWidth = width;
  ctx.setLineDash(dash);
  for (const { centre, vector } of cells) {
    const from = project(centre);
    const to = project(centre.map((v, k) => v + magnification * vector[k]));
    ctx.beginPath();
    ctx.moveTo(...from);
    ctx.lineTo(...to);
    ctx.stroke();
    ctx.fillRect(to[0] - 1.8, to[1] - 1.8, 3.6, 3.6);
  }
  ctx.restore();
}

function drawBase(ctx, scene) {
  if (scene.empty) return;
  drawVolume(ctx, scene);
  for (const { before } of scene.parts) if (before) drawCells(ctx, scene, before, kBefore, { opacity: 0.55, width: 1.2 });
  scene.parts.forEach(({ now, name, words }, k) => {
    drawCells(ctx, scene, now, name);
    if (words) text(ctx, words, scene.box.left + 6 + 110 * k, scene.box.top + 12, { name });
  });
  text(ctx, `magnified ${Number((1e3 * scene.magnification).toPrecision(2)).toLocaleString('en-US')} ×; drag turns, Shift and drag marks`, scene.box.left + 6, scene.box.bottom + 18);
}

function drawOverlay(ctx, scene, { selection, preview }) {
  if (scene.empty) return;
  if (preview && preview.residual.length === scene.view.length) {
    for (const { mask } of scene.parts) drawCells(ctx, scene, scene.of(preview.residual, mask), kPreview, { dash: [4, 2] });
  }
  if (!selection.mask) return;
  ctx.fillStyle = hex(kMarked);
  const step = Math.max(1, Math.floor(selection.count / 4000));
  const { left, top } = placesOf(scene);
  let seen = 0;
  for (let i = 0; i < selection.mask.length; i += 1) {
    if (!selection.mask[i] || (seen += 1) % step !== 0) continue;
    ctx.fillRect(left[i] - 1.2, top[i] - 1.2, 2.4, 2.4);
  }
}

function brush(scene, { x0, x1, y0, y1 }) {
  if (scene.empty) return null;
  const { left, top } = placesOf(scene);
  return (i) => left[i] >= x0 && left[i] <= x1 && top[i] >= y0 && top[i] <= y1;
}

function readout(scene, x, y) {
  if (scene.empty) return scene.empty;
  let best = null;
  let distance = 14;
  for (const { now } of scene.parts) {
    for (const cell of now) {
      const [u, v] = scene.project(cell.centre);
      const off = Math.hypot(u - x, v - y);
      if (off < distance) [best, distance] = [cell, off];
    }
  }
  if (!best) return null;
  return `at ${best.centre.map((v) => fixed(v, 0)).join(', ')} mm: ${best.vector.map((v, k) => `${'XYZ'[k]} ${fixed(v, 2)}`).join(', ')}, size ${significant(Math.hypot(...best.vector), 3)} µm of ${best.count} readings`;
}

export const vectors = {
  kind: 'vectors', title: 'vectors in space', controls: ['split', 'turn'], turns: true,
  needs: (config, variables) => ['point_x', 'point_y', 'point_z', 'along_x', 'along_y', 'along_z', ...(directionsOf(variables).some(({ name }) => name === config.split) ? [config.split] : [])],
  prepare, drawBase, drawOverlay, brush, readout, brushBox: ({ box }) => box,
};
