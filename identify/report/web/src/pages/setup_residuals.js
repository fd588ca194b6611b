import { count, el, fixed, longTable, note, significant, table } from '../dom.js';
import { meansOverReadings } from '../lenses/means_strip.js';
import { addPlot, jitter, plain } from '../plot.js';
import { color, instrumentIndex, instrumentMark, series, transparent } from '../theme.js';

const kJitter = 0.3;

/** Readings of the last model by setup, means of every model above them. */
function setupsPlot(data, rows, angle) {
  const { records, models } = data;
  const unit = angle ? 'µrad' : 'µm';
  const place = new Map(rows.map((row, k) => [row.setup, k]));
  const drawn = [...records.setup.keys()].filter((i) => Boolean(records.angle[i]) === angle && place.has(records.setup[i]));
  const instruments = [...new Set(rows.map((row) => row.instrument))];
  const last = records.residual.at(-1);
  const squares = drawn.reduce((sum, i) => sum + records.sigma[i] ** 2, 0) / Math.max(1, drawn.length);
  const band = 2 * Math.sqrt(squares);
  const limit = 1.06 * Math.max(1.2 * band, ...drawn.map((i) => Math.abs(last[i])));
  const points = instruments.map((instrument) => {
    const own = drawn.filter((i) => rows[place.get(records.setup[i])].instrument === instrument);
    return {
      x: own.map((i) => place.get(records.setup[i]) + kJitter * jitter(i)), y: own.map((i) => last[i]), type: 'scatter', mode: 'markers', showlegend: false,
      marker: { size: 3, opacity: 0.5, color: series(instrumentIndex(instrument)) },
      text: own.map((i) => `<b>${plain(rows[place.get(records.setup[i])].name)}</b>, line ${records.file_line[i]}<br>residual ${fixed(last[i], 2)} ${unit}, σ ${fixed(records.sigma[i], 2)} ${unit}`), hovertemplate: '%{text}<extra></extra>',
    };
  });
  const shades = models.length > 1 ? [color('muted'), color('text')] : [color('text')];
  const means = models.map((name, m) => ({
    x: rows.map((_, k) => k + (models.length > 1 ? [-0.1, 0.1][m] : 0)), mean: rows.map((row) => row.models[m].mean), band: rows.map((row) => row.models[m].band), shade: shades[m], name: `mean, ${plain(name)}`,
    text: rows.map((row) => `<b>${plain(row.name)}</b>, ${plain(name)}<br>mean ${fixed(row.models[m].mean, 3)} ± ${significant(row.models[m].band, 2)} ${unit}, RMS ${significant(row.models[m].rms)} ${unit}, ${count(row.count)} readings`),
  }));
  const step = Math.ceil(rows.length / 60);
  const ticks = rows.map((_, k) => k).filter((k) => k % step === 0);
  return meansOverReadings({
    height: 400, points, means, meanTitle: `mean [${unit}]`, legend: models.length > 1,
    x: { title: 'Setup', tickvals: ticks, ticktext: ticks.map((k) => plain(rows[k].name)), tickangle: rows.length > 8 ? -60 : 0, zeroline: false, showgrid: false, range: [-0.6, rows.length - 0.4] },
    y: { title: `residual [${unit}]`, range: [-limit, limit] },
    shapes: [{ type: 'rect', xref: 'paper', yref: 'y', x0: 0, x1: 1, y0: -band, y1: band, fillcolor: transparent(color('muted'), 0.13), line: { width: 0 }, layer: 'below' }],
  });
}

const setupTable = (data) => longTable([
  { name: 'Setup', align: 'left', cell: (row) => row.name },
  { name: 'Instrument', align: 'left', cell: (row) => instrumentMark(row.instrument) },
  { name: 'Observations', cell: (row) => count(row.count) },
  ...data.models.flatMap((_, m) => {
    const of = data.models.length > 1 ? ` ${'AB'[m]}` : '';
    return [
      { name: `Mean${of}`, cell: (row) => fixed(row.models[m].mean, 2) },
      { name: '± 2 s', cell: (row) => significant(row.models[m].band, 2) },
      { name: `RMS${of}`, cell: (row) => significant(row.models[m].rms) },
    ];
  }),
  { name: 'Unit', align: 'left', cell: (row) => (row.angle ? 'µrad' : 'µm') },
], data.setups, { caption: 'Residuals by setup', rowClass: (row) => (Math.abs(row.models.at(-1).mean) > row.models.at(-1).band ? 'marked' : null) });

const pointsTable = (rows) => table([
  { name: 'Setup', align: 'left', cell: (row) => row.setup },
  { name: '', align: 'left', cell: (row) => row.source },
  { name: 'Points', cell: (row) => count(row.points) },
  { name: 'RMS |e|', unit: 'µm', cell: (row) => significant(row.rms) },
  { name: 'Max |e|', unit: 'µm', cell: (row) => significant(row.max) },
  ...['x', 'y', 'z'].map((axis, i) => ({ name: `Range ${axis}`, unit: 'µm', cell: (row) => significant(row.range[i]) })),
], rows, { caption: 'Error vectors at points' });

export function renderSetupResiduals(body, data) {
  body.append(note('Reading minus prediction. Above: signed means on a scale of their own, with bars of ± 2 standard deviations: those of independent readings, or what the scatter between the lines says where that is more. Below: readings, with the band of ± 2 σ as stated.',
    data.drawn < data.total ? ` ${count(data.drawn)} of ${count(data.total)} readings are drawn, the largest and an even choice of the others; means use all.` : ''));
  for (const angle of [false, true]) {
    const rows = data.setups.filter((row) => row.angle === angle);
    if (rows.length === 0) continue;
    const node = el('div', { class: 'plot' });
    body.append(el('figure', {}, [el('figcaption', {}, `${angle ? 'Angles' : 'Lengths'}, ${data.models.at(-1)}`), node]));
    addPlot(node, () => setupsPlot(data, rows, angle));
  }
  if (data.points.length > 0) body.append(el('h3', {}, 'Error vectors at points'), pointsTable(data.points));
  body.append(el('h3', {}, 'Every setup'), setupTable(data), note('Marked: a mean beyond its bar.'));
}
