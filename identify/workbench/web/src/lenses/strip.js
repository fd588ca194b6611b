// Means of the readings in a strip of its own scale: a mean that noise buries among the readings stands out there.
import { meansInBins } from '../data/statistics.js';
import { axisBelow, axisLeft } from '../draw/axes.js';
import { band, bars, curve } from '../draw/curves.js';
import { kBefore, kNow, kPreview } from '../draw/palette.js';
import { linear } from '../draw/scale.js';
import { valuesOf } from './values.js';

const kSigmas = 2;

function meansOf(view, config, residual, axis, mask = view.shown) {
  const { values, weight } = valuesOf(view, config, residual);
  return meansInBins(axis.index, axis.bins, values, view.lines, { mask, weight });
}

/** Range that holds zero, all means and, as far as they are of a size with these or `whole`, their bars. */
function meanRange(lists, whole) {
  let [low, high] = [0, 0];
  for (const means of lists.filter(Boolean)) {
    for (let k = 0; k < means.mean.length; k += 1) {
      if (!(means.count[k] >= 3)) continue;
      const [mean, u] = [means.mean[k], whole ? kSigmas * means.u[k] : Math.min(kSigmas * means.u[k], 2 * Math.abs(means.mean[k]) + 1e-12)];
      if (mean - u < low) low = mean - u;
      if (mean + u > high) high = mean + u;
    }
  }
  const edge = 0.08 * (high - low) || 1;
  return [low - edge, high + edge];
}

const ends = (means, sign) => Array.from(means.mean, (mean, k) => mean + sign * kSigmas * means.u[k]);
const pixels = (values, scale) => Array.from(values, (value) => scale(value));

function clipped(ctx, box, draw) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
  ctx.clip();
  draw();
  ctx.restore();
}

function drawMeans(ctx, strip, means, name, { aside = 0, banded = true, dash = [] } = {}) {
  const xs = strip.axis.centres.map((value) => strip.sx(value) + (strip.axis.steps ? aside : 0));
  const [ys, lows, highs] = [means.mean, ends(means, -1), ends(means, 1)].map((values) => pixels(values, strip.sy));
  if (strip.axis.steps) {
    bars(ctx, xs, ys, lows, highs, name);
    return;
  }
  if (banded) band(ctx, xs, lows, highs, name);
  curve(ctx, xs, ys, name, { dash });
}

export function makeStrip(view, config, box, axis, sx, title) {
  const now = meansOf(view, config, view.now, axis);
  const before = view.before ? meansOf(view, config, view.before, axis) : null;
  const [low, high] = meanRange([now, before], axis.steps !== null);
  return { box, axis, sx, now, before, sy: linear(low, high, box.bottom, box.top), title };
}

export function drawStrip(ctx, strip, labels = true) {
  const { box, axis, sx, sy } = strip;
  axisBelow(ctx, box, sx, axis.title, { steps: axis.steps, labels });
  axisLeft(ctx, box, sy, strip.title, 4);
  clipped(ctx, box, () => {
    if (strip.before) drawMeans(ctx, strip, strip.before, kBefore, { aside: -5, banded: false });
    drawMeans(ctx, strip, strip.now, kNow, { aside: strip.before ? 5 : 0 });
  });
}

/** Means as they would be with what is looked at. */
export function drawPreviewMeans(ctx, strip, view, config, residual) {
  const means = meansOf(view, config, residual, strip.axis);
  clipped(ctx, strip.box, () => drawMeans(ctx, strip, means, kPreview, { aside: 10, banded: false, dash: [5, 3] }));
}
