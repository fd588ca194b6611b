// How often a residual occurs, before and now.
import { count, fixed, significant } from '../../../../report/web/src/dom.js';
import { histogram, magnitudeQuantile } from '../data/statistics.js';
import { axisBelow, axisLeft } from '../draw/axes.js';
import { alpha, hex, kBefore, kMarked, kNow, kPreview } from '../draw/palette.js';
import { linear } from '../draw/scale.js';
import { namesOf, titleOfValues, unitOf, valuesOf } from './values.js';

const kBins = 61;

function prepare(view, config, size) {
  const box = { left: 58, right: size.width - 12, top: 8, bottom: size.height - 38 };
  const dots = (residual) => valuesOf(view, config, residual).dots;
  const reach = 1.1 * Math.max(...[view.now, view.before].filter(Boolean).map((residual) => magnitudeQuantile(dots(residual), 0.998, view.shown)));
  const counts = (residual, mask = view.shown) => histogram(dots(residual), -reach, reach, kBins, mask);
  const [now, before] = [counts(view.now), view.before ? counts(view.before) : null];
  const most = 1.08 * Math.max(...now, ...(before ?? [0]), 1);
  return { view, config, box, now, before, counts, dots: dots(view.now), sx: linear(-reach, reach, box.left, box.right), sy: linear(0, most, box.bottom, box.top) };
}

function outline(ctx, { sx, sy }, counts) {
  ctx.beginPath();
  const width = (sx.high - sx.low) / kBins;
  ctx.moveTo(sx(sx.low), sy(0));
  counts.forEach((n, k) => {
    ctx.lineTo(sx(sx.low + k * width), sy(n));
    ctx.lineTo(sx(sx.low + (k + 1) * width), sy(n));
  });
  ctx.lineTo(sx(sx.high), sy(0));
}

function area(ctx, scene, counts, name, opacity, dash = []) {
  outline(ctx, scene, counts);
  ctx.fillStyle = alpha(name, opacity);
  ctx.fill();
  ctx.save();
  ctx.setLineDash(dash);
  ctx.strokeStyle = hex(name);
  ctx.lineWidth = 1.4;
  ctx.stroke();
  ctx.restore();
}

function drawBase(ctx, scene) {
  axisBelow(ctx, scene.box, scene.sx, titleOfValues(scene.view, scene.config));
  axisLeft(ctx, scene.box, scene.sy, 'readings');
  if (scene.before) area(ctx, scene, scene.before, kBefore, 0.25);
  area(ctx, scene, scene.now, kNow, 0.3);
}

function drawOverlay(ctx, scene, { selection, preview }) {
  if (preview && preview.residual.length === scene.view.length) area(ctx, scene, scene.counts(preview.residual), kPreview, 0, [5, 3]);
  if (selection.mask) area(ctx, scene, histogram(scene.dots, scene.sx.low, scene.sx.high, kBins, selection.mask), kMarked, 0.7);
}

function brush({ sx, dots }, { x0, x1 }) {
  const [low, high] = [sx.invert(x0), sx.invert(x1)];
  return (i) => dots[i] >= low && dots[i] <= high;
}

function readout({ sx, now, before, view, config }, x) {
  const k = Math.floor(((sx.invert(x) - sx.low) / (sx.high - sx.low)) * kBins);
  if (!(k >= 0 && k < kBins)) return null;
  const centre = sx.low + ((k + 0.5) * (sx.high - sx.low)) / kBins;
  return `${fixed(centre, 2)} ${unitOf(view, config)}: ${count(now[k])} readings${before ? `, before ${count(before[k])}` : ''}; each step is ${significant((sx.high - sx.low) / kBins, 2)} wide`;
}

export const histogramLens = {
  kind: 'histogram', title: 'histogram', controls: ['of', 'perSigma'], needs: namesOf,
  prepare, drawBase, drawOverlay, brush, readout, brushBox: ({ box }) => box,
};
