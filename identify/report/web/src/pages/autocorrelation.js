import { el, note, significant } from '../dom.js';
import { addPlot, layout2d, legendAbove } from '../plot.js';
import { color, instrumentIndex, instrumentMark, series, transparent } from '../theme.js';

function correlationPlot(one) {
  const gap = one.gap_s.map((seconds) => (seconds === null ? '' : `, ${seconds < 120 ? `${significant(seconds, 2)} s` : `${significant(seconds / 60, 2)} min`} apart`));
  const trace = (key, name, shade, more) => ({
    x: one.lag, y: one[key], text: gap, type: 'scatter', mode: 'lines+markers', name, line: { color: shade, width: 1.8, ...more }, marker: { size: 6, color: shade },
    hovertemplate: `${name}: %{y:.3f}<br>lag %{x} readings%{text}<extra></extra>`,
  });
  return {
    data: [
      { x: [...one.lag, ...[...one.lag].reverse()], y: [...one.band, ...one.band.map((b) => -b).reverse()], type: 'scatter', mode: 'lines', fill: 'toself', fillcolor: transparent(color('muted'), 0.16), line: { width: 0 }, hoverinfo: 'skip', name: 'white noise, ± 2 standard deviations' },
      trace('residual', 'residuals', color('bad'), {}),
      { ...trace('expected', 'noise model', color('text'), { dash: 'dot', width: 1.2 }), mode: 'lines' },
      trace('whitened', 'after whitening', series(instrumentIndex(one.instrument)), {}),
    ],
    layout: layout2d({
      height: 350, margin: { t: 34 }, ...legendAbove(), hovermode: 'closest',
      x: { title: 'lag [readings]', type: 'log', tickvals: one.lag, zeroline: false }, y: { title: 'autocorrelation [–]' },
    }),
  };
}

export function renderAutocorrelation(body, data) {
  body.append(note('Residuals of the model reached: correlation of readings of one setup and run that follow each other at a lag. The filter of the noise model should leave nothing outside the band; residuals lie below the noise model’s own curve where the fit has absorbed part of the correlated drift.'));
  if (data.instruments.length === 0) {
    body.append(note('There are too few readings in a row.'));
    return;
  }
  const grid = el('div', { class: data.instruments.length > 1 ? 'pair' : '' });
  for (const one of data.instruments) {
    const node = el('div', { class: 'plot' });
    grid.append(el('figure', {}, [el('figcaption', {}, instrumentMark(one.instrument)), node]));
    addPlot(node, () => correlationPlot(one));
  }
  body.append(grid);
}
