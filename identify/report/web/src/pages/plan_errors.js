import { bar, fixed, note, significant, symbolMark, table } from '../dom.js';

const less = (row) => (row.U[0] === null || row.U[1] === null || row.U[1] === undefined ? '–' : fixed(100 * (1 - row.U[0] / row.U[1]), 0));

export function renderPlanErrors(body, data) {
  const largest = {};
  for (const row of data.errors) {
    for (const value of row.U) if (value !== null) largest[row.unit] = Math.max(largest[row.unit] ?? 0, value);
  }
  const columns = [
    { name: 'Error', align: 'left', cell: (row) => symbolMark(row.symbol, row.axis) },
    ...data.campaigns.flatMap((name, k) => [
      { name: `U, ${name}`, align: 'left', cell: (row) => (row.U[k] === null ? '' : bar(row.U[k] / largest[row.unit], row.axis)) },
      { name: '', cell: (row) => (row.U[k] === null ? 'not visible' : significant(row.U[k], 2)) },
    ]),
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
    { name: 'Less by', unit: '%', cell: less },
    { name: 'Visible fraction', cell: (row) => fixed(row.visible_fraction, 3) },
    { name: 'Effective parameters', cell: (row) => fixed(row.effective_parameters, 1) },
  ];
  body.append(
    table(columns, data.errors, { rowClass: (row) => (row.visible ? null : 'dim'), className: 'bars' }),
    note(`U95 = 1.96 u, root mean square over the travel, by linear propagation on the nominal machine with the noise and roughness that are assumed. Less by: ${data.campaigns[0]} against ${data.campaigns[1] ?? data.campaigns[0]}. Visible fraction and effective parameters are those of the plan. Bars are relative to the largest of the same unit.`),
  );
}
