// An error motion of a rotary axis over its positions, outwards positive, about a circle that stands for zero, with its
// 95 % band. data: { axis, symbol, unit, position: degrees, extrapolated: 0/1, curves: [{ direction, value, U95 }] }.
import { addPlot, plain } from '../plot.js';
import { significant } from '../dom.js';
import { color, series, transparent } from '../theme.js';
import { kLimit, placeOf, polarHeight, polarLayout, rings, ringsFor, spokes } from './polar.js';

const kApproach = { '-1': ['approach −', 'dot', 2], 0: ['', 'solid', null], 1: ['approach +', 'dash', 1] };

const kLargestHeight = 360;
const kRoom = 1.1; // for the numbers of degrees

/** Largest distance of a band from zero. */
export const reachOf = (data) => Math.max(1e-3, ...data.curves.flatMap((curve) => curve.value.map((v, i) => Math.abs(v) + curve.U95[i])));

/** What a ring stands for. */
export const motionRing = (data) => ringsFor(reachOf(data)).step;

const asTrace = (points) => ({ x: points.map(([x]) => x), y: points.map(([, y]) => y), type: 'scatter' });

function band(data, curve, place, hue) {
  const outer = data.position.map((angle, i) => place(angle, curve.value[i] + curve.U95[i]));
  const inner = data.position.map((angle, i) => place(angle, curve.value[i] - curve.U95[i])).reverse();
  return { ...asTrace([...outer, ...inner]), mode: 'lines', line: { width: 0 }, fill: 'toself', fillcolor: transparent(hue, 0.25), hoverinfo: 'skip' };
}

/** Measured positions strong, the others weak and dashed. */
function lines(data, curve, place, hue) {
  const [words, dash] = kApproach[curve.direction];
  const at = data.position.map((angle, i) => [angle, curve.value[i], curve.U95[i]]);
  return [0, 1].filter((flag) => data.extrapolated.includes(flag)).map((flag) => ({
    ...asTrace(data.position.map((angle, i) => (data.extrapolated[i] === flag ? place(angle, curve.value[i]) : [null, null]))),
    mode: 'lines', connectgaps: false, line: { color: hue, width: flag ? 1.2 : 2, dash: flag ? 'dash' : dash }, opacity: flag ? 0.6 : 1, customdata: at,
    hovertemplate: `${data.axis} %{customdata[0]:.1f}°: <b>${data.symbol}</b> %{customdata[1]:.2f} ± %{customdata[2]:.2f} ${data.unit}${words ? `, ${words}` : ''}${flag ? '<br>extrapolated' : ''}<extra></extra>`,
  }));
}

const hueOf = (data, curve) => {
  if (data.visible === false) return color('muted');
  const [, , index] = kApproach[curve.direction];
  return index === null ? color(`axis-${data.axis}`) : series(index);
};

/** `words`: written into the plot, where it has no caption. */
export function motionFigure(data, height, words = '') {
  const { step, count } = ringsFor(reachOf(data));
  const title = { shapes: [], annotations: words === '' ? [] : [{ xref: 'paper', yref: 'paper', x: 0, y: 0, xanchor: 'left', yanchor: 'bottom', text: words, showarrow: false, font: { size: 11, color: color('muted') } }] };
  const place = placeOf(count * step);
  const ends = [0, 90, 180, 270].map((angle) => [angle, `${angle}°`, color('muted')]);
  return {
    paperHeight: 0.55,
    data: data.curves.flatMap((curve) => [band(data, curve, place, hueOf(data, curve)), ...lines(data, curve, place, hueOf(data, curve))]),
    layout: polarLayout(height, [spokes(ends), rings(count * step, step, count, true), title], kRoom * kLimit),
  };
}

export const addMotion = (node, make) => addPlot(node, () => motionFigure(make(), polarHeight(node, kLargestHeight)));

const inOrder = (data, values) => data.angle.map((angle, i) => [angle, values[i]]).sort(([a], [b]) => a - b);

/** An axis-of-rotation test: measured, and predicted dashed. data: { angle: degrees, unit, traces: [{ name, values, dash }] }. */
export function turnFigure(data, height) {
  const { step, count } = ringsFor(Math.max(1e-3, ...data.traces.flatMap(({ values }) => values.map(Math.abs))));
  const place = placeOf(count * step);
  const ends = [0, 90, 180, 270].map((angle) => [angle, `${angle}°`, color('muted')]);
  return {
    paperHeight: 0.55,
    data: data.traces.map(({ name, values, dash }, n) => ({
      ...asTrace(inOrder(data, values).map(([angle, value]) => place(angle, value))), mode: 'lines+markers', marker: { size: n === 0 ? 4 : 1, color: series(n) }, line: { color: series(n), width: n === 0 ? 1.2 : 2.2, dash },
      customdata: inOrder(data, values), hovertemplate: `${plain(name)}, %{customdata[0]:.1f}°: %{customdata[1]:.2f} ${data.unit}<extra></extra>`,
    })),
    layout: polarLayout(height, [spokes(ends), rings(count * step, step, count, true)], kRoom * kLimit),
  };
}

export const addTurn = (node, make) => addPlot(node, () => turnFigure(make(), polarHeight(node, kLargestHeight)));

/** Largest value with its sign, where it was measured. */
export function peakOf(data) {
  let peak = 0;
  for (const { value } of data.curves) value.forEach((v, i) => { if (!data.extrapolated[i] && Math.abs(v) > Math.abs(peak)) peak = v; });
  return peak;
}

export const motionCaption = (data) => `${data.meaning}; range ${significant(data.range)} ${data.unit}, rings ${significant(motionRing(data), 2)} ${data.unit} apart`;
