import { el, fixed, note, significant, table } from '../dom.js';
import { addPlot, layout2d, plain } from '../plot.js';
import { color, series } from '../theme.js';

const shadeOf = (row) => (row.found ? color('bad') : series(0));

/** Bars of RMS over the volume with U95, largest on top. */
function causesPlot(data) {
  const rows = [...data.rows].reverse();
  const y = rows.map((_, k) => k);
  const ends = rows.map((row) => row.rms_um + (row.U95_um ?? 0));
  return {
    paperHeight: 0.8,
    data: [{
      x: rows.map((row) => row.rms_um), y, type: 'scatter', mode: 'markers', marker: { size: 6, color: color('text') },
      error_x: { type: 'data', array: rows.map((row) => row.U95_um ?? 0), color: color('text'), thickness: 1.3, width: 4 },
      text: rows.map((row) => `${plain(row.name)}: ${significant(row.rms_um)}${row.U95_um === null ? '' : ` ± ${significant(row.U95_um, 2)}`} µm RMS, ${fixed(100 * row.share, 1)} %`), hovertemplate: '%{text}<extra></extra>',
    }],
    layout: layout2d({
      height: 70 + 26 * rows.length, margin: { l: 10, r: 64, t: 6 }, hovermode: 'closest',
      x: { title: 'displacement in the volume [µm RMS], ± U95', range: [0, 1.02 * Math.max(...ends)], zeroline: false },
      y: { title: '', tickvals: y, ticktext: rows.map((row) => plain(row.name)), showgrid: false, zeroline: false, range: [-0.6, rows.length - 0.4] },
      shapes: rows.map((row, k) => ({ type: 'rect', x0: 0, x1: row.rms_um, y0: k - 0.3, y1: k + 0.3, fillcolor: shadeOf(row), line: { width: 0 }, layer: 'between' })),
      annotations: rows.map((row, k) => ({ xref: 'paper', x: 1, xanchor: 'left', xshift: 6, y: k, showarrow: false, text: `${fixed(100 * row.share, row.share < 0.1 ? 1 : 0)} %`, font: { size: 11, color: color('text') } })),
    }),
  };
}

export function renderVolumeCauses(body, data) {
  body.append(note(`What each cause displaces the functional point of tool ${data.tool} by over the work volume, approached from both sides, without the best rigid motion; together ${significant(data.total_um)} µm RMS. Shares of the mean square sum to 100 %; a negative one cancels part of the others. Red: found by this diagnosis. Error functions are those of the given model, so that what they took over from a missing effect is still in them.`));
  const node = el('div', { class: 'plot' });
  body.append(el('figure', {}, [el('figcaption', {}, 'Causes of the volumetric error'), node]), table([
    { name: 'Cause', align: 'left', cell: (row) => row.name },
    { name: 'RMS', unit: 'µm', cell: (row) => significant(row.rms_um) },
    { name: '± U95', unit: 'µm', cell: (row) => significant(row.U95_um, 2) },
    { name: 'Share', unit: '%', cell: (row) => fixed(100 * row.share, 1) },
    { name: '', align: 'left', cell: (row) => (row.found ? 'found here' : '') },
  ], data.rows, { caption: 'Causes of the volumetric error' }));
  addPlot(node, () => causesPlot(data));
  if (data.not_in_volume.length > 0) body.append(note(`In the readings alone, not in the error of the machine: ${data.not_in_volume.join(', ')}.`));
}
