// Lines with bars or bands.
import { alpha, hex } from './palette.js';

/** A line through finite points; gaps where there are none. */
export function curve(ctx, xs, ys, name, { width = 1.6, dash = [], opacity = 1 } = {}) {
  ctx.save();
  ctx.strokeStyle = opacity === 1 ? hex(name) : alpha(name, opacity);
  ctx.lineWidth = width;
  ctx.lineJoin = 'round';
  ctx.setLineDash(dash);
  ctx.beginPath();
  let down = false;
  for (let k = 0; k < xs.length; k += 1) {
    const finite = Number.isFinite(xs[k]) && Number.isFinite(ys[k]);
    if (finite && down) ctx.lineTo(xs[k], ys[k]);
    else if (finite) ctx.moveTo(xs[k], ys[k]);
    down = finite;
  }
  ctx.stroke();
  ctx.restore();
}

/** A band between two curves, piece by piece. */
export function band(ctx, xs, lows, highs, name, opacity = 0.18) {
  ctx.fillStyle = alpha(name, opacity);
  for (let k = 1; k < xs.length; k += 1) {
    if (![xs[k], xs[k - 1], lows[k], lows[k - 1], highs[k], highs[k - 1]].every(Number.isFinite)) continue;
    ctx.beginPath();
    ctx.moveTo(xs[k - 1], lows[k - 1]);
    ctx.lineTo(xs[k], lows[k]);
    ctx.lineTo(xs[k], highs[k]);
    ctx.lineTo(xs[k - 1], highs[k - 1]);
    ctx.fill();
  }
}

/** Points with bars. */
export function bars(ctx, xs, ys, lows, highs, name, size = 3) {
  ctx.strokeStyle = hex(name);
  ctx.fillStyle = hex(name);
  ctx.lineWidth = 1.4;
  for (let k = 0; k < xs.length; k += 1) {
    if (!Number.isFinite(ys[k])) continue;
    ctx.beginPath();
    ctx.moveTo(xs[k], lows[k]);
    ctx.lineTo(xs[k], highs[k]);
    ctx.stroke();
    ctx.beginPath();
    ctx.arc(xs[k], ys[k], size, 0, 7);
    ctx.fill();
  }
}
