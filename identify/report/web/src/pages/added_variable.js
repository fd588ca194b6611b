import { el, note, significant } from '../dom.js';
import { addPlot, layout2d, legendAbove, plain } from '../plot.js';
import { color, transparent } from '../theme.js';

function partialPlot(data) {
  const { mean } = data;
  const ends = [Math.min(...data.driver), Math.max(...data.driver)];
  const size = Math.max(Math.min(5, Math.max(...data.residual.map(Math.abs))), ...mean.mean.map((value, k) => Math.abs(value) + 2 * mean.noise[k]));
  const line = (slope) => ends.map((x) => slope * x);
  const unit = plain(data.unit);
  const per = unit === '' ? '' : ` per ${unit}`;
  return {
    data: [
      { x: data.driver, y: data.residual, type: 'scatter', mode: 'markers', marker: { size: 3, opacity: 0.4, color: color('data') }, name: 'readings', hovertemplate: `partial driver %{x:.3g}<br>partial residual %{y:.2f} σ<extra></extra>` },
      {
        x: [...ends, ...[...ends].reverse()], y: [...line(data.amplitude - data.U95), ...line(data.amplitude + data.U95).reverse()],
        type: 'scatter', mode: 'lines', fill: 'toself', fillcolor: transparent(color('bad'), 0.18), line: { width: 0 }, hoverinfo: 'skip', name: '± U95',
      },
      { x: ends, y: line(data.amplitude), type: 'scatter', mode: 'lines', line: { color: color('bad'), width: 2 }, name: `slope ${significant(data.amplitude)} ${unit}`, hoverinfo: 'skip' },
      {
        x: mean.centre, y: mean.mean, error_y: { type: 'data', array: mean.noise.map((u) => 2 * u), color: color('text'), thickness: 1.2, width: 3 }, type: 'scatter', mode: 'markers', marker: { size: 7, color: color('text') },
        text: mean.count, name: 'means ± 2 standard deviations', hovertemplate: 'mean of %{text} readings: %{y:.3f} σ<extra></extra>',
      },
    ],
    layout: layout2d({
      height: 430, margin: { t: 34 }, ...legendAbove(), hovermode: 'closest',
      x: { title: `partial driver [σ${per}]` }, y: { title: 'partial residual [σ]', range: [-1.05 * size, 1.05 * size] },
    }),
  };
}

export function renderAddedVariable(body, data) {
  if (data.label === '') {
    body.append(note('No effect of the catalogue is visible in these readings: there is nothing to plot.'));
    return;
  }
  body.append(
    el('p', {}, [el('strong', {}, data.label), ` ${significant(data.amplitude)} ± ${significant(data.U95, 2)} ${data.unit} (95 %); `,
      data.alternative ? 'one of the alternatives.' : data.accepted ? 'added to the model.' : 'the strongest candidate, not added.']),
    note('Both the residuals and the effect’s driver are regressed on everything else in the model and freed of correlated noise: the slope is the amplitude. Points on the line far from the middle speak for the effect; one point alone far out does not. In units of the noise, σ.'),
  );
  const node = el('div', { class: 'plot' });
  body.append(node);
  addPlot(node, () => partialPlot(data));
}
