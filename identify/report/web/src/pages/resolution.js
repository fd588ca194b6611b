import { fixed, longTable, note, symbolMark } from '../dom.js';

const basisText = (row) => (row.basis === 'bspline' ? `B-spline, degree ${row.degree}` : row.basis === 'zero' ? 'zero' : `${row.basis}, degree ${row.degree}`);
const rangeText = ([from, to]) => `${fixed(from, 1)} … ${fixed(to, 1)}`;

export function renderResolution(body, data) {
  body.append(
    longTable([
      { name: 'Symbol', align: 'left', cell: (row) => symbolMark(row.symbol, row.axis) },
      { name: 'Basis', align: 'left', cell: basisText },
      { name: 'Intervals', cell: (row) => (row.intervals > 0 ? row.intervals : '–') },
      { name: 'Length of one', cell: (row) => fixed(row.interval_length, 1) },
      { name: 'Effective parameters', cell: (row) => fixed(row.effective_parameters, 1) },
      { name: 'Smoothing', align: 'left', cell: (row) => (row.smoothed ? 'by evidence' : 'none') },
      { name: 'Measured positions', cell: (row) => rangeText(row.measured) },
      { name: 'Travel', cell: (row) => rangeText(row.travel) },
      { name: 'Unit', align: 'left', cell: (row) => row.position_unit },
    ], data.rows),
    note('Effective parameters: how many independent values of the function the readings support. A function with a smoothing prior has more intervals than it needs; the prior takes out what the readings do not show.'),
  );
}
