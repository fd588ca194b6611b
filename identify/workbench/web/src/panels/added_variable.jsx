// Added-variable plot: residuals over the part of a driver that the model does not explain.
import { useEffect, useRef } from 'preact/hooks';
import { onThemeChange } from '../../../../report/web/src/theme.js';
import { view } from '../app/view.js';
import { binIndex, magnitudeQuantile, meansInBins, rangeOf } from '../data/statistics.js';
import { axisBelow, axisLeft } from '../draw/axes.js';
import { bars, curve } from '../draw/curves.js';
import { drawReadings, places } from '../draw/density.js';
import { kNow, kPreview } from '../draw/palette.js';
import { linear } from '../draw/scale.js';

const kBins = 12;
const kHeight = 210;

function slopeOf(driver, residual, shown) {
  let [top, bottom] = [0, 0];
  for (let i = 0; i < driver.length; i += 1) {
    if (!shown[i] || driver[i] !== driver[i] || residual[i] !== residual[i]) continue;
    top += driver[i] * residual[i];
    bottom += driver[i] * driver[i];
  }
  return bottom > 0 ? top / bottom : 0;
}

function draw(canvas, driver, label) {
  const now = view.value;
  const width = canvas.parentElement.clientWidth;
  if (!now || width < 100 || driver.length !== now.length) return;
  const ratio = Math.min(2, globalThis.devicePixelRatio || 1);
  Object.assign(canvas, { width: width * ratio, height: kHeight * ratio });
  const ctx = canvas.getContext('2d');
  ctx.scale(ratio, ratio);
  const box = { left: 58, right: width - 12, top: 8, bottom: kHeight - 38 };
  const [low, high] = rangeOf(driver, now.shown) ?? [0, 1];
  const reach = 1.1 * magnitudeQuantile(now.now, 0.99, now.shown);
  const [sx, sy] = [linear(low, high, box.left, box.right), linear(-reach, reach, box.bottom, box.top)];
  axisBelow(ctx, box, sx, label);
  axisLeft(ctx, box, sy, `residual [${now.unit}]`);
  drawReadings(ctx, box, places(driver, now.now, box, sx, sy, now.shown), kNow, { opacity: 0.35 });
  const means = meansInBins(binIndex(driver, low, high, kBins), kBins, now.now, now.lines, { mask: now.shown });
  const centres = Array.from({ length: kBins }, (_, k) => sx(low + ((k + 0.5) * (high - low)) / kBins));
  const at = (sign) => Array.from(means.mean, (mean, k) => sy(mean + sign * 2 * means.u[k]));
  bars(ctx, centres, at(0), at(-1), at(1), kNow);
  const slope = slopeOf(driver, now.now, now.shown);
  curve(ctx, [sx(low), sx(high)], [sy(slope * low), sy(slope * high)], kPreview, { width: 2 });
}

export function AddedVariable({ driver, effect }) {
  const canvas = useRef();
  const label = 'what the formula adds to the model';
  useEffect(() => {
    const again = () => canvas.current && draw(canvas.current, driver, label);
    again();
    const stop = onThemeChange(again);
    const observer = new ResizeObserver(again);
    observer.observe(canvas.current.parentElement);
    return () => {
      observer.disconnect();
      stop();
    };
  }, [driver, view.value]);
  return <figure class="added-variable"><figcaption>Residuals over what it adds: a slope is its amplitude</figcaption><div><canvas ref={canvas} style={{ height: `${kHeight}px`, width: '100%' }} role="img" aria-label={`Residuals over what ${effect.label} adds to the model`} /></div></figure>;
}
