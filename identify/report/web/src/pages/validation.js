import { count, el, fixed, note, significant, table } from '../dom.js';
import { printed } from '../words.js';

export function renderValidation(body, data) {
  body.append(el('div', { class: `status ${data.level}` }, [
    el('strong', {}, data.seen),
    ...data.rows.map((row) => el('p', {}, `${row.name}: RMS ${significant(row.rms_before)} → ${significant(row.rms_after)} ${row.unit} (${fixed(100 * (1 - row.rms_after / Math.max(row.rms_before, 1e-12)), 0)} % less).`)),
    data.warning === '' ? null : el('p', {}, printed(data.warning)),
  ]));
  body.append(table([
    { name: 'Readings', align: 'left', cell: (row) => row.name },
    { name: 'Number', cell: (row) => count(row.count) },
    { name: 'RMS before', cell: (row) => significant(row.rms_before, 4) },
    { name: 'RMS after', cell: (row) => significant(row.rms_after, 4) },
    { name: 'Max before', cell: (row) => significant(row.max_before, 4) },
    { name: 'Max after', cell: (row) => significant(row.max_after, 4) },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
  ], data.rows), note(`Before: the nominal machine; after: the identified errors. ${fixed(data.coverage_percent, 1)} % of the readings lie inside ${data.coverage_factor} √(u² of the model + σ²); 95 % is expected. χ² per degree of freedom with both: ${fixed(data.reduced_chi2, 3)}.`));
}
