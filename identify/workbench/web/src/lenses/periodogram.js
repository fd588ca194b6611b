// Power over the period along a variable, and the residuals folded to the period chosen.
import { fixed, significant } from '../../../../report/web/src/dom.js';
import { binIndex, magnitudeQuantile } from '../data/statistics.js';
import { unitText } from '../data/variables.js';
import { axisLeft, frame, line, text } from '../draw/axes.js';
import { curve } from '../draw/curves.js';
import { drawReadings, places } from '../draw/density.js';
import { kBefore, kMarked, kNow, kPreview } from '../draw/palette.js';
import { linear } from '../draw/scale.js';
import { drawPreviewMeans, drawStrip, makeStrip } from './strip.js';
import { explained, namesOf, titleOfValues, unitOf, valuesOf } from './values.js';

const kPhases = 24;
const kPeriods = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];

const folds = new WeakMap();

function folded(values, period) {
  const kept = folds.get(values);
  if (kept?.period === period) return kept.phase;
  const phase = new Float32Array(values.length);
  for (let i = 0; i < values.length; i += 1) phase[i] = values[i] / period - Math.floor(values[i] / period);
  folds.set(values, { period, phase });
  return phase;
}

function powerScales(spectrum, box) {
  const logs = spectrum.period.map(Math.log10);
  const finite = logs.filter(Number.isFinite);
  const most = Math.max(...spectrum.power.filter(Number.isFinite), spectrum.level ?? 0, 1);
  return { logs, sx: linear(Math.min(...finite), Math.max(...finite), box.left, box.right), sy: linear(0, 1.1 * most, box.bottom, box.top) };
}

function prepare(view, config, size) {
  const values = view.column(config.x);
  const variable = view.variables.find(({ name }) => name === config.x);
  const spectrum = config.spectrum;
  if (!values || !variable) return null;
  if (!spectrum || spectrum.period.length < 2) return { empty: spectrum?.problem ?? 'The program looks for periods.' };
  const middle = 8 + 0.4 * (size.height - 110);
  const box = { left: 58, right: size.width - 12, top: 8, bottom: middle };
  const second = { ...box, top: middle + 38, bottom: middle + 38 + 0.3 * (size.height - 110) };
  const third = { ...box, top: second.bottom + 8, bottom: size.height - 38 };
  const period = config.period > 0 ? config.period : spectrum.peak;
  const phase = folded(values, period);
  const sx = linear(0, 1, box.left, box.right);
  const axis = { steps: null, bins: kPhases, index: binIndex(phase, 0, 1, kPhases), centres: Array.from({ length: kPhases }, (_, k) => (k + 0.5) / kPhases), title: `phase within ${significant(period, 4)} ${unitText(variable.unit)} of ${variable.label}` };
  const reach = 1.15 * magnitudeQuantile(valuesOf(view, config, view.now).dots, 0.995, view.shown);
  const sy = linear(-reach, reach, second.bottom, second.top);
  const where = (residual) => places(phase, valuesOf(view, config, residual).dots, second, sx, sy, view.shown);
  return { view, config, variable, spectrum, period, phase, box, second, sx, sy, where, now: where(view.now), before: view.before ? where(view.before) : null, strip: makeStrip(view, config, third, axis, sx, 'mean'), power: powerScales(spectrum, box) };
}

function drawPower(ctx, { box, power, spectrum, period, variable }) {
  axisLeft(ctx, box, power.sy, 'power', 3);
  for (const value of kPeriods) {
    const x = power.sx(Math.log10(value));
    if (x < box.left || x > box.right) continue;
    line(ctx, Math.round(x) + 0.5, box.top, Math.round(x) + 0.5, box.bottom, 'grid');
    text(ctx, String(value), x, box.bottom + 14, { align: 'center' });
  }
  text(ctx, `period${variable.unit ? ` [${unitText(variable.unit)}]` : ''}`, (box.left + box.right) / 2, box.bottom + 28, { align: 'center' });
  curve(ctx, power.logs.map(power.sx), spectrum.power.map(power.sy), kNow, { width: 1.2 });
  if (Number.isFinite(spectrum.level)) {
    const y = power.sy(spectrum.level);
    curve(ctx, [box.left, box.right], [y, y], 'bad', { width: 1, dash: [4, 3] });
    text(ctx, 'chance alone stays below', box.right - 4, y < box.top + 16 ? y + 13 : y - 4, { align: 'right', name: 'bad' });
  }
  const x = power.sx(Math.log10(period));
  curve(ctx, [x, x], [box.top, box.bottom], kMarked, { width: 1.4 });
  frame(ctx, box);
}

function drawBase(ctx, scene) {
  if (scene.empty) return;
  drawPower(ctx, scene);
  axisLeft(ctx, scene.second, scene.sy, titleOfValues(scene.view, scene.config), 3);
  if (scene.before) drawReadings(ctx, scene.second, scene.before, kBefore, { opacity: 0.28 });
  drawReadings(ctx, scene.second, scene.now, kNow, { opacity: 0.5 });
  drawStrip(ctx, scene.strip);
}

function drawOverlay(ctx, scene, { selection, preview }) {
  if (scene.empty) return;
  if (preview && preview.residual.length === scene.view.length) {
    drawReadings(ctx, scene.second, scene.where(explained(scene.view.now, preview.residual)), kPreview, { opacity: 0.8 });
    drawPreviewMeans(ctx, scene.strip, scene.view, scene.config, preview.residual);
  }
  if (selection.mask) drawReadings(ctx, scene.second, scene.now, kMarked, { mask: selection.mask, opacity: 0.9, floor: 0.8, size: 4 });
}

function brush({ sx, phase, box, empty }, { x0, x1, y1 }) {
  if (empty || y1 <= box.bottom) return null;
  const [low, high] = [sx.invert(x0), sx.invert(x1)];
  return (i) => phase[i] >= low && phase[i] <= high;
}

/** A click on the power chooses the period: the highest place near the click. */
function click({ power, spectrum, box, empty }, x, y) {
  if (empty || y > box.bottom) return null;
  let best = -1;
  power.logs.forEach((value, k) => {
    if (Math.abs(power.sx(value) - x) < 6 && (best < 0 || spectrum.power[k] > spectrum.power[best])) best = k;
  });
  return best < 0 ? null : { period: spectrum.period[best] };
}

function readout({ power, spectrum, box, strip, view, config, empty, sx, variable }, x, y) {
  if (empty) return empty;
  if (y <= box.bottom) {
    const value = 10 ** power.sx.invert(x);
    const k = spectrum.period.reduce((best, period, m) => (Math.abs(period - value) < Math.abs(spectrum.period[best] - value) ? m : best), 0);
    return `period ${significant(spectrum.period[k], 4)} ${unitText(variable.unit)}: power ${fixed(spectrum.power[k], 1)}; a click folds to it`;
  }
  const k = Math.max(0, Math.min(kPhases - 1, Math.floor(sx.invert(x) * kPhases)));
  return `phase ${fixed((k + 0.5) / kPhases, 2)}: mean ${fixed(strip.now.mean[k], 2)} ± ${significant(2 * strip.now.u[k], 2)} ${unitOf(view, config)}`;
}

const isPosition = ({ kind, name }) => kind === 'position' || kind === 'point' || ['x', 'y', 'z'].includes(name);

export const periodogram = {
  /** Periods along a position alone: others repeat nothing. */
  adjust: (config, variables) => (variables.some((variable) => variable.name === config.x && isPosition(variable)) ? config : { ...config, x: variables.find(isPosition)?.name ?? config.x }),
  kind: 'periodogram', title: 'periods in', controls: ['x', 'period', 'of'], positionsOnly: true, asks: 'periodogram',
  needs: (config) => [config.x, ...namesOf(config)], prepare, drawBase, drawOverlay, brush, click, readout, brushBox: (scene) => scene.box && ({ ...scene.box, top: scene.second.top, bottom: scene.strip.box.bottom }),
};
