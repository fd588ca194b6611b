// Drift at rest over time: measured, and predicted dashed, less the first reading.
// data: { drift, unit, time: hours, sources: [measured, model ...] with their values }.
import { addPlot, layout2d, legendAbove, plain } from '../plot.js';
import { color, series } from '../theme.js';

function trace(data, source, n) {
  const hue = n === 0 ? series(0) : color('text');
  return {
    x: data.time, y: source.value, type: 'scatter', mode: n === 0 ? 'lines+markers' : 'lines', name: plain(source.name), marker: { size: 4, color: hue }, line: { color: hue, width: n === 0 ? 1.2 : 2.2, dash: n === 0 ? 'solid' : 'dash' },
    hovertemplate: `${plain(source.name)}, %{x:.2f} h: %{y:.2f} ${data.unit}<extra></extra>`,
  };
}

function driftFigure(data, model) {
  return {
    paperHeight: 0.6, data: [trace(data, data.sources[0], 0), trace(data, model, 1)],
    layout: layout2d({ height: 260, margin: { t: 40 }, ...legendAbove(), hovermode: 'closest', x: { title: 'time [h]', zeroline: false }, y: { title: `${plain(data.drift)} [${data.unit}]` } }),
  };
}

/** `chosen`: which of the models is drawn; gives what draws it again. */
export const addDrift = (node, data, chosen) => addPlot(node, () => driftFigure(data, data.sources[1 + chosen()]));
