import { count, fixed, longTable, note } from '../dom.js';

export function renderOutliers(body, data) {
  const expected = data.observations * 2 * (1 - normalCdf(data.critical));
  body.append(note(
    `Baarda's w-test, |w| > ${fixed(data.critical, 2)}: ${count(data.suspect)} of ${count(data.observations)} readings; `,
    `${fixed(expected, expected < 10 ? 1 : 0)} expected by chance.`,
    data.suspect === 0 ? '' : ` ${data.removed === 0 ? 'None' : count(data.removed)} ${data.removed === 1 ? 'was' : 'were'} taken out of the adjustment; the others are kept.`));
  if (data.rows.length === 0) return;
  body.append(longTable([
    { name: 'Setup', align: 'left', cell: (row) => row.setup },
    { name: 'Instrument', align: 'left', cell: (row) => row.instrument },
    { name: 'Line of the file', cell: (row) => row.file_line },
    { name: 'Channel', cell: (row) => row.channel + 1 },
    { name: 'Residual', cell: (row) => fixed(row.residual, 2) },
    { name: 'σ', cell: (row) => fixed(row.sigma, 2) },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
    { name: 'Redundancy', cell: (row) => fixed(row.redundancy, 2) },
    { name: 'w', cell: (row) => fixed(row.w, 2) },
    { name: '', align: 'left', cell: (row) => (row.removed ? 'taken out' : 'kept') },
  ], data.rows));
  if (data.suspect > data.rows.length) {
    body.append(note(`The ${count(data.rows.length)} worst are listed; residuals.csv has all.`));
  }
}

/** Standard normal distribution function (Abramowitz and Stegun 7.1.26, error < 1.5e-7). */
function normalCdf(z) {
  const x = Math.abs(z) / Math.SQRT2;
  const t = 1 / (1 + 0.3275911 * x);
  const poly = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
  const erf = 1 - poly * Math.exp(-x * x);
  return z < 0 ? 0.5 * (1 - erf) : 0.5 * (1 + erf);
}
