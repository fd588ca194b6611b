import { count, fixed, longTable, note } from '../dom.js';
import { instrumentMark } from '../theme.js';

export function renderOutliers(body, data) {
  body.append(note(
    `Baarda's w-test, |w| > ${fixed(data.critical, 2)}: ${count(data.suspect)} of ${count(data.observations)} readings. `,
    `With a right model and right noise the chance that any is suspected is ${Number((100 * data.chance).toPrecision(2))}\u00a0%.`,
    data.left_out === 0 ? '' : ` ${count(data.left_out)} ${data.left_out === 1 ? 'is' : 'are'} left out by the campaign, with the reason in its file.`,
    data.suspect === data.left_out ? '' : ` ${data.removed === 0 ? 'None' : count(data.removed)} ${data.removed === 1 ? 'was' : 'were'} taken out of the adjustment; the others are kept.`));
  if (data.rows.length === 0) return;
  body.append(longTable([
    { name: 'Setup', align: 'left', cell: (row) => row.setup },
    { name: 'Instrument', align: 'left', cell: (row) => instrumentMark(row.instrument) },
    { name: 'Line of the file', cell: (row) => row.file_line },
    { name: 'Channel', cell: (row) => row.channel + 1 },
    { name: 'Residual', cell: (row) => fixed(row.residual, 2) },
    { name: 'σ', cell: (row) => fixed(row.sigma, 2) },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
    { name: 'Redundancy', cell: (row) => fixed(row.redundancy, 2) },
    { name: 'w', cell: (row) => fixed(row.w, 2) },
    { name: '', align: 'left', cell: (row) => row.state },
  ], data.rows));
  if (data.suspect > data.rows.length) {
    body.append(note(`The ${count(data.rows.length)} worst are listed; residuals.csv has all.`));
  }
}
