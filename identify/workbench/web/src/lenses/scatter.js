// Residuals against a variable: readings, and their means in a strip below. Over time: temperatures in a third strip.
import { fixed, significant } from '../../../../report/web/src/dom.js';
import { magnitudeQuantile } from '../data/statistics.js';
import { temperaturesOf, timeOf } from '../data/variables.js';
import { axisBelow, axisLeft, text } from '../draw/axes.js';
import { curve } from '../draw/curves.js';
import { drawReadings, places } from '../draw/density.js';
import { kBefore, kMarked, kNow, kPreview } from '../draw/palette.js';
import { linear } from '../draw/scale.js';
import { abscissa } from './abscissa.js';
import { drawPreviewMeans, drawStrip, makeStrip } from './strip.js';
import { explained, namesOf, titleOfValues, unitOf, valuesOf } from './values.js';
import { meansInBins, rangeOf } from '../data/statistics.js';

const kLeft = 58;
const kBelow = 38;
const kGap = 10;

function boxes({ width, height }, third) {
  const [left, right, top] = [kLeft, width - 12, 8];
  const room = height - top - kBelow - kGap * (third ? 2 : 1);
  const heights = third ? [0.46, 0.28, 0.26] : [0.58, 0.42];
  let at = top;
  return heights.map((share) => {
    const box = { left, right, top: at, bottom: at + share * room };
    at = box.bottom + kGap;
    return box;
  });
}

function pointsScale(view, config, box) {
  const sizes = [view.now, view.before].filter(Boolean).map((residual) => magnitudeQuantile(valuesOf(view, config, residual).dots, 0.995, view.shown));
  const reach = 1.15 * Math.max(...sizes, 1e-9);
  return linear(-reach, reach, box.bottom, box.top);
}

function beyond(where, shown, length) {
  let count = 0;
  for (let i = 0; i < length; i += 1) if (shown[i] && where.column[i] < 0) count += 1;
  return count;
}

function temperatureCurves(view, axis, box, sx) {
  const columns = temperaturesOf(view.variables).map((variable) => ({ variable, values: view.column(variable.name) })).filter(({ values }) => values);
  const means = columns.map(({ variable, values }) => ({ label: variable.label, mean: meansInBins(axis.index, axis.bins, values, null, { mask: view.shown }).mean }));
  const range = rangeOf(means.flatMap(({ mean }) => [...mean])) ?? [0, 1];
  const edge = 0.1 * (range[1] - range[0]) || 0.5;
  return { box, sx, means, sy: linear(range[0] - edge, range[1] + edge, box.bottom, box.top) };
}

function prepare(view, config, size) {
  const axis = abscissa(view, config.x);
  if (!axis) return null;
  const third = config.kind === 'time' && temperaturesOf(view.variables).length > 0;
  const [box, stripBox, thirdBox] = boxes(size, third);
  const sx = linear(axis.low, axis.high, box.left, box.right);
  const sy = pointsScale(view, config, box);
  const where = (residual) => places(axis.values, valuesOf(view, config, residual).dots, box, sx, sy, view.shown, axis.shift);
  return {
    view, config, box, axis, sx, sy, where, now: where(view.now), before: view.before ? where(view.before) : null,
    strip: makeStrip(view, config, stripBox, axis, sx, 'mean'), temperatures: third ? temperatureCurves(view, axis, thirdBox, sx) : null,
  };
}

function drawTemperatures(ctx, { box, sx, sy, means }, axis) {
  axisBelow(ctx, box, sx, axis.title, { steps: axis.steps });
  axisLeft(ctx, box, sy, '°C', 3);
  means.forEach(({ label, mean }, k) => {
    curve(ctx, axis.centres.map(sx), Array.from(mean, sy), `series-${(k + 1) % 10}`);
    text(ctx, label, box.left + 6 + 90 * k, box.top + 12, { name: `series-${(k + 1) % 10}` });
  });
}

function drawBase(ctx, scene) {
  const { box, sx, sy, axis, view, config } = scene;
  axisBelow(ctx, box, sx, null, { steps: axis.steps, labels: false });
  axisLeft(ctx, box, sy, titleOfValues(view, config));
  if (scene.before) drawReadings(ctx, box, scene.before, kBefore, { opacity: 0.28 });
  drawReadings(ctx, box, scene.now, kNow, { opacity: 0.5 });
  const out = beyond(scene.now, view.shown, view.length);
  if (out > 0 && (!config.of || config.of === 'reading')) text(ctx, `${out} beyond this scale`, box.right - 4, box.top + 13, { align: 'right' });
  drawStrip(ctx, scene.strip, !scene.temperatures);
  if (scene.temperatures) drawTemperatures(ctx, scene.temperatures, axis);
}

function drawOverlay(ctx, scene, { selection, preview }) {
  const { view, config } = scene;
  if (preview && preview.residual.length === view.length) {
    drawReadings(ctx, scene.box, scene.where(explained(view.now, preview.residual)), kPreview, { opacity: 0.8 });
    drawPreviewMeans(ctx, scene.strip, view, config, preview.residual);
  }
  if (selection.mask) drawReadings(ctx, scene.box, scene.now, kMarked, { mask: selection.mask, opacity: 0.9, floor: 0.8, size: 4 });
}

/** In the picture of the readings a rectangle, in the strips all between two values of the variable. */
function brush(scene, { x0, x1, y0, y1 }) {
  const { axis, sx, now, box } = scene;
  if (y0 >= box.top - 2 && y1 <= box.bottom + 2) {
    const [left, right, top, bottom] = [x0 - box.left, x1 - box.left, y0 - box.top, y1 - box.top];
    return (i) => now.column[i] >= left && now.column[i] <= right && now.row[i] >= top && now.row[i] <= bottom;
  }
  const [low, high] = [sx.invert(x0), sx.invert(x1)];
  const { values, shift } = axis;
  return shift ? (i) => values[i] + shift[i] >= low && values[i] + shift[i] <= high : (i) => values[i] >= low && values[i] <= high;
}

function readout(scene, x, y) {
  const { axis, sx, strip, view, config } = scene;
  const value = sx.invert(x);
  const k = axis.centres.reduce((best, centre, m) => (Math.abs(centre - value) < Math.abs(axis.centres[best] - value) ? m : best), 0);
  if (!Number.isFinite(strip.now.mean[k])) return null;
  const place = axis.steps ? axis.steps.text[k] : significant(axis.centres[k], 4);
  const words = (means) => `${fixed(means.mean[k], 2)} ± ${significant(2 * means.u[k], 2)}`;
  return `${axis.variable.label} ${place}: mean ${words(strip.now)} ${unitOf(view, config)}, ${strip.now.count[k]} readings${strip.before ? `; before ${words(strip.before)}` : ''}`;
}

const lens = { prepare, drawBase, drawOverlay, brush, readout, brushBox: (scene) => ({ ...scene.box, bottom: (scene.temperatures ?? scene.strip).box.bottom }) };

export const scatter = {
  ...lens, kind: 'scatter', title: 'residuals against', controls: ['x', 'of', 'perSigma'],
  needs: (config) => [config.x, ...namesOf(config)],
};

export const timeLine = {
  ...lens, kind: 'time', title: 'over time', controls: ['of', 'perSigma'],
  adjust: (config, variables) => ({ ...config, x: timeOf(variables)?.name ?? 'row' }),
  needs: (config, variables) => [config.x, ...namesOf(config), ...temperaturesOf(variables).map(({ name }) => name)],
};
