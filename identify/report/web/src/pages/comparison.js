import { count, el, fixed, longTable, note, significant, table } from '../dom.js';
import { printed } from '../words.js';

const kLetters = 'AB';

/** Columns of RMS, mean and χ² per degree of freedom, one of each per model. */
function modelColumns(models, of) {
  const name = (m) => (models.length > 1 ? `${kLetters[m]}` : '');
  const kinds = [['lengths', 'µm'], ['angles', 'µrad']].filter(([kind]) => models.some((model) => model.total[kind].count > 0));
  const columns = [];
  for (const [kind, unit] of kinds) {
    models.forEach((_, m) => columns.push({ name: `RMS ${name(m)}`, unit, cell: (row) => significant(of(row, m)[kind].rms) }));
    models.forEach((_, m) => columns.push({ name: `Mean ${name(m)}`, unit, cell: (row) => significant(of(row, m)[kind].mean, 2) }));
  }
  models.forEach((_, m) => columns.push({ name: `χ²/dof ${name(m)}`, cell: (row) => significant(of(row, m).reduced_chi2) }));
  return columns;
}

const totalsTable = (data) => table([
  { name: 'Model', align: 'left', cell: (row) => row.name },
  { name: 'Observations', cell: (row) => count(row.observations) },
  ...['lengths', 'angles'].filter((kind) => data.models.some((model) => model.total[kind].count > 0)).flatMap((kind) => {
    const unit = kind === 'lengths' ? 'µm' : 'µrad';
    return [
      { name: `RMS of ${kind}`, unit, cell: (row) => significant(row.total[kind].rms, 4) },
      { name: 'Mean', unit, cell: (row) => significant(row.total[kind].mean, 2) },
      { name: 'Max', unit, cell: (row) => significant(row.total[kind].max) },
    ];
  }),
  { name: 'χ²/dof', cell: (row) => significant(row.total.reduced_chi2) },
], data.models, { caption: 'Residuals of the models' });

const placesTable = (data) => longTable([
  { name: 'By', align: 'left', cell: (row) => row.by },
  { name: 'Where', align: 'left', cell: (row) => row.where },
  { name: 'Observations', cell: (row) => count(row.observations) },
  ...modelColumns(data.models, (row, m) => row.models[m]),
  { name: '', align: 'left', cell: (row) => row.models.at(-1).mark },
], data.places.rows, { caption: 'Where the residuals are worst' });

export function renderComparison(body, data) {
  body.append(el('div', { class: `status ${data.level}` }, [el('strong', {}, `${data.headline}: ${data.model}`), ...data.words.map((text) => el('p', {}, printed(text)))]));
  if (data.notes.length > 0) body.append(el('ul', { class: 'messages' }, data.notes.map((text) => el('li', {}, printed(text)))));
  body.append(totalsTable(data), note('Reading minus prediction, with the stated noise; stations, dead paths, alignments and other nuisance parameters are estimated anew for every model.'));
  if (data.held_out.length > 0) {
    body.append(el('h3', {}, 'Held-out lines, used in no fit'), table([
      { name: 'Model', align: 'left', cell: (row) => row.name },
      { name: '', align: 'left', cell: (row) => (row.fitted ? 'fitted anew without them' : 'nothing to fit') },
      { name: 'Observations', cell: (row) => count(row.observations) },
      { name: 'RMS of lengths', unit: 'µm', cell: (row) => significant(row.total.lengths.rms, 4) },
      { name: 'RMS of angles', unit: 'µrad', cell: (row) => significant(row.total.angles.rms, 4) },
      { name: 'χ²/dof', cell: (row) => fixed(row.total.reduced_chi2, 3) },
    ], data.held_out));
  }
  body.append(el('h3', {}, 'Places, directions and times that are worst'));
  if (data.places.rows.length === 0) {
    body.append(note(`None of ${count(data.cells)} setups, places, directions and times is worse than chance (χ² tests, 5 % over all of them).`));
  } else {
    const rest = data.places.found - data.places.rows.length;
    body.append(placesTable(data), note(`χ² tests, 5 % over all ${count(data.cells)} setups, places, directions and times.${rest > 0 ? ` ${count(rest)} more are worse than chance.` : ''}`));
  }
  if (data.no_tests.length > 0) {
    body.append(el('h3', {}, 'No test of a standard'), el('ul', {}, data.no_tests.map((text) => el('li', {}, printed(text)))));
  }
}
