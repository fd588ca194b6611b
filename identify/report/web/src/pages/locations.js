import { decimalsFor, fixed, note, symbolMark, table } from '../dom.js';

const stateText = { off: 'left out of the model', convention: 'zero by convention', invisible: 'not visible', identified: '' };

export function renderLocations(body, data) {
  const decimals = Math.max(1, ...data.rows.filter((row) => row.state === 'identified').map((row) => decimalsFor(row.U95)));
  const number = (key) => (row) => (row.state === 'identified' ? fixed(row[key], decimals) : '–');
  body.append(
    table([
      { name: 'Symbol', align: 'left', cell: (row) => symbolMark(row.symbol, row.axis) },
      { name: 'Meaning', align: 'left', cell: (row) => row.meaning },
      { name: 'Value', cell: number('value') },
      { name: 'u', cell: number('u') },
      { name: 'U95', cell: number('U95') },
      { name: 'Unit', align: 'left', cell: (row) => row.unit },
      { name: 'Over the travel', unit: 'µm', cell: (row) => (row.state === 'identified' ? fixed(row.over_travel_um, 1) : '–') },
      { name: 'of', unit: 'mm', cell: (row) => fixed(row.travel_mm, 0) },
      { name: '', align: 'left', cell: (row) => [stateText[row.state], row.reason].filter(Boolean).join(': ') },
    ], data.rows, { rowClass: (row) => (row.state === 'identified' ? null : 'dim') }),
    note(`Datum: primary ${data.primary}, secondary ${data.secondary}. Positive squareness turns the axis by the right-hand rule about its first letter. U95 = ${fixed(data.coverage, 2)}\u00a0u.`),
  );
}
