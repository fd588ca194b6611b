// Positioning along a line by ISO 230-2: mean deviations at the targets from both sides with ± 2 s, what a model
// predicts there, the difference in a strip of its own scale, and the figures.
// data: { abscissa, position, unit, sources: [measured, model ...] } as the report's C++ side writes it.
import { el, significant, table } from '../dom.js';
import { addPlot, layout2d, legendAbove, plain } from '../plot.js';
import { color, series } from '../theme.js';

const kSides = [['positive', 'forward', () => series(0), 'triangle-right'], ['negative', 'reverse', () => color('warning'), 'triangle-left']];
const kStrip = 0.27; // of the height, for the difference

const known = (values) => values.some((value) => value !== null);
const difference = (one, other) => one.map((value, i) => (value === null || other[i] === null ? null : value - other[i]));

/** Mean of both directions. */
const middle = (source) => source.positive.mean.map((value, i) => (value === null || source.negative.mean[i] === null ? null : (value + source.negative.mean[i]) / 2));

function measuredTraces(data, source) {
  const x = data.position;
  const traces = kSides.filter(([side]) => known(source[side].mean)).map(([side, words, shade, symbol]) => ({
    x, y: source[side].mean, type: 'scatter', mode: 'lines+markers', name: `${words}, ± 2 s`, line: { color: shade(), width: 1.5 }, marker: { size: 6, symbol, color: shade() },
    error_y: known(source[side].s) ? { type: 'data', array: source[side].s.map((s) => (s === null ? 0 : 2 * s)), color: shade(), thickness: 1, width: 2 } : undefined,
    text: source[side].count, hovertemplate: `${words}: %{y:.2f} ${data.unit}, mean of %{text}<extra></extra>`,
  }));
  if (traces.length === 2) {
    traces.push({ x, y: middle(source), type: 'scatter', mode: 'lines', name: 'mean', line: { color: color('text'), width: 1.2, dash: 'dash' }, hovertemplate: `mean of both: %{y:.2f} ${data.unit}<extra></extra>` });
  }
  return traces;
}

function modelTraces(data, source) {
  return kSides.filter(([side]) => known(source[side].mean)).map(([side, words, shade], k) => ({
    x: data.position, y: source[side].mean, type: 'scatter', mode: 'lines', name: 'predicted', legendgroup: 'predicted', showlegend: k === 0, line: { color: shade(), width: 2.4, dash: 'dot' },
    hovertemplate: `predicted, ${words}: %{y:.2f} ${data.unit}<extra></extra>`,
  }));
}

function differenceTraces(data, measured, model) {
  return kSides.filter(([side]) => known(measured[side].mean)).map(([side, words, shade, symbol]) => ({
    x: data.position, y: difference(measured[side].mean, model[side].mean), type: 'scatter', mode: 'lines+markers', yaxis: 'y2', showlegend: false,
    line: { color: shade(), width: 1.3 }, marker: { size: 5, symbol, color: shade() }, hovertemplate: `measured less predicted, ${words}: %{y:.2f} ${data.unit}<extra></extra>`,
  }));
}

function figure(data, model) {
  const [measured] = data.sources;
  const layout = layout2d({
    height: 360, margin: { t: 40 }, ...legendAbove(), hovermode: 'closest',
    x: { title: plain(data.abscissa), zeroline: false, anchor: 'y2' }, y: { title: `deviation [${data.unit}]`, domain: [kStrip + 0.05, 1] },
  });
  layout.yaxis2 = { ...layout.yaxis, domain: [0, kStrip], title: { text: `rest [${data.unit}]`, font: { size: 11 }, standoff: 6 }, rangemode: 'tozero', nticks: 4 };
  return { paperHeight: 0.7, data: [...modelTraces(data, model), ...measuredTraces(data, measured), ...differenceTraces(data, measured, model)], layout };
}

const figureRows = [
  ['A', 'accuracy of positioning'], ['E', 'systematic deviation'], ['R', 'repeatability'], ['M', 'mean bidirectional deviation'], ['B', 'reversal value, largest'], ['mean_B', 'mean reversal value, signed'],
];

/** A, E, R of both directions together and of each; M and B of both. */
function figuresTable(data, model) {
  const [measured] = data.sources;
  const shown = (source, side, key) => (source[side][key] === undefined ? '' : significant(source[side][key]));
  return table([
    { name: '', align: 'left', cell: ([key]) => (key === 'mean_B' ? 'B\u0304' : key) },
    { name: 'Measured', unit: `both, ${data.unit}`, cell: ([key]) => shown(measured, 'both', key) },
    { name: 'Forward', unit: data.unit, cell: ([key]) => shown(measured, 'forward', key) },
    { name: 'Reverse', unit: data.unit, cell: ([key]) => shown(measured, 'reverse', key) },
    { name: 'Predicted', unit: `both, ${data.unit}`, cell: ([key]) => shown(model, 'both', key) },
    { name: '', align: 'left', cell: ([, words]) => el('span', { class: 'muted' }, words) },
  ], figureRows, { className: 'card-figures', caption: `Figures of ISO 230-2, ${data.title}, ${data.setup}` });
}

/** A card in `node`; `chosen()` is the index of the model that is compared with. Returns a function that draws it again. */
export function addIsoCard(node, data, chosen) {
  const plot = el('div', { class: 'plot' });
  const figures = el('div', {});
  const model = () => data.sources[1 + chosen()];
  const fill = () => figures.replaceChildren(figuresTable(data, model()));
  fill();
  node.append(plot, figures);
  const redraw = addPlot(plot, () => figure(data, model()));
  return () => {
    fill();
    redraw();
  };
}
