import { count, el, fixed, longTable, note, table } from '../dom.js';
import { noiseTable } from '../noise_table.js';
import { instrumentMark } from '../theme.js';

function noiseVerdict(row) {
  const distance = Math.abs(row.scale - 1) / Math.max(row.u, 1e-12);
  if (distance < 2) return 'as stated';
  return row.scale > 1 ? 'stated σ is too small' : 'stated σ is too large';
}

function noiseModel(noise) {
  if (!noise.estimated) return [note('Readings were taken as independent; correlated drift, offsets of lines and a part in proportion to length were not looked for.')];
  if (!noise.more_than_white) return [note('Independent readings suffice: no correlated drift, offset of lines or part in proportion to length is supported by the readings.')];
  return [
    noiseTable(noise.rows.filter((row) => row.value !== 0)),
    note(`The readings' noise is not independent. Its terms come from restricted maximum likelihood; weights and uncertainties allow for them. χ² of the whitened residuals per degree of freedom: ${fixed(noise.reduced, 3)}.`),
  ];
}

export function renderSetups(body, data) {
  body.append(
    el('h3', {}, 'Noise found in the readings'),
    table([
      { name: 'Instrument', align: 'left', cell: (row) => instrumentMark(row.instrument) },
      { name: 'Observations', cell: (row) => count(row.observations) },
      { name: 'Redundancy', cell: (row) => fixed(row.redundancy, 1) },
      { name: 'Found / stated σ', cell: (row) => fixed(row.scale, 3) },
      { name: 'u', cell: (row) => fixed(row.u, 3) },
      { name: 'Verdict', align: 'left', cell: noiseVerdict },
    ], data.components),
    note('Variance component of each kind of instrument: the factor by which its stated standard deviation (of the independent part, where there is another) must be multiplied to agree with the residuals. The uncertainties of this report use the found values.'),
    ...noiseModel(data.noise),
    el('h3', {}, 'Setups'),
    longTable([
      { name: 'Setup', align: 'left', cell: (row) => row.name },
      { name: 'Instrument', align: 'left', cell: (row) => instrumentMark(row.instrument) },
      { name: 'Tool', align: 'left', cell: (row) => row.tool },
      { name: 'Observations', cell: (row) => count(row.observations) },
      { name: 'Redundancy', cell: (row) => fixed(row.redundancy, 1) },
      { name: 'χ²', title: 'with the stated σ', cell: (row) => fixed(row.chi2, 1) },
      { name: 'χ² / redundancy', cell: (row) => fixed(row.reduced, 3) },
      { name: 'RMS residual', cell: (row) => fixed(row.rms, 3) },
      { name: 'Max residual', cell: (row) => fixed(row.max, 3) },
      { name: 'Unit', align: 'left', cell: (row) => row.unit },
    ], data.setups, { rowClass: (row) => (Math.abs(row.reduced - 1) > 4 * Math.sqrt(2 / Math.max(row.redundancy, 1)) ? 'marked' : null) }),
    note('χ² with the stated σ; 1 per redundancy is expected. Marked: further from 1 than four standard deviations of χ².'),
  );
}
