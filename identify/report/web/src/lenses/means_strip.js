// Readings over an abscissa, and their means above them in a strip of its own scale: a mean that noise buries among
// the readings stands out there.
// { x, y, means: [{ x, mean, band, text, name, shade, size }], points, shapes, height }; traces of the plot library in `points`.
import { layout2d, legendAbove } from '../plot.js';
import { color } from '../theme.js';

const kStrip = 0.36; // of the height

function meanTrace({ x, mean, band, text, name, shade, line = false }) {
  return {
    x, y: mean, text, type: 'scatter', mode: line ? 'lines+markers' : 'markers', name, yaxis: 'y2', line: { color: shade, width: 1.6 }, marker: { size: 6, color: shade },
    error_y: { type: 'data', array: band, color: shade, thickness: 1.2, width: line ? 0 : 3 }, hovertemplate: '%{text}<extra></extra>',
  };
}

/** Range that holds zero, the means and their bars. */
function meanRange(means) {
  const ends = means.flatMap(({ mean, band }) => mean.flatMap((value, k) => (value === null ? [] : [value - (band[k] ?? 0), value + (band[k] ?? 0)])));
  const [low, high] = [Math.min(0, ...ends), Math.max(0, ...ends)];
  const edge = 0.08 * (high - low) || 1;
  return [low - edge, high + edge];
}

export function meansOverReadings({ x, y, meanTitle, means, points, shapes = [], height = 330, legend = false }) {
  const layout = layout2d({
    height, margin: { t: legend ? 34 : 8 }, ...(legend ? legendAbove() : {}), hovermode: 'closest', shapes,
    x: { ...x, anchor: 'y' }, y: { ...y, domain: [0, 1 - kStrip - 0.06] },
  });
  layout.yaxis2 = { ...layout.yaxis, domain: [1 - kStrip, 1], range: meanRange(means), nticks: 5, zerolinecolor: color('zero'), title: { text: meanTitle, font: { size: 11 }, standoff: 6 } };
  return { data: [...points, ...means.map(meanTrace)], layout };
}
