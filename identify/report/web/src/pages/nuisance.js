import { count, decimalsFor, el, fixed, longTable, note, significant } from '../dom.js';

const heldBy = (row) => {
  if (row.prior_sigma === null) return 'free';
  return row.weak_default_prior ? 'weak default prior' : 'prior as given';
};

export function renderNuisance(body, data) {
  body.append(longTable([
    { name: 'Parameter', align: 'left', cell: (row) => row.name },
    { name: '', align: 'left', cell: (row) => row.label },
    { name: 'Value', cell: (row) => fixed(row.value, decimalsFor(row.u)) },
    { name: 'u', cell: (row) => fixed(row.u, decimalsFor(row.u)) },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
    { name: 'Guess', cell: (row) => fixed(row.guess, Math.min(4, decimalsFor(row.u))) },
    { name: 'Change', cell: (row) => fixed(row.change, decimalsFor(row.u)) },
    { name: 'Prior σ', cell: (row) => significant(row.prior_sigma, 3) },
    { name: 'Held by', align: 'left', cell: heldBy },
  ], data.rows));
  if (data.count > data.rows.length) {
    body.append(note(`The first ${count(data.rows.length)} of ${count(data.count)} are listed; result.json has all.`));
  }
  if (data.held_by_prior.length > 0) {
    body.append(el('h3', {}, 'Held at the guess by a weak default prior'), el('ul', {}, data.held_by_prior.map((name) => el('li', {}, name.replaceAll('+-', '±')))));
  }
  body.append(note('Unknowns that the measurement brought with it. What is invisible by nature, such as the out-of-plane centre of a plane circle, is held by a weak default prior and says nothing about the machine.'));
}
