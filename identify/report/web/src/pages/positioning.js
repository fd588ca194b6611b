import { count, el, note, significant, table } from '../dom.js';
import { addIsoCard } from '../lenses/iso_card.js';
import { modelChoice } from './model_choice.js';

function cards(body, data, chosen, redraws) {
  const grid = el('div', { class: 'pair cards' });
  for (const card of data.cards) {
    const node = el('figure', { class: 'card' }, [
      el('figcaption', {}, [el('strong', { class: card.axis ? `axis-${card.axis}` : null }, card.title), ` (${card.setup})`]),
    ]);
    redraws.push(addIsoCard(node, card, () => chosen.index));
    if (card.position.length < card.targets) node.append(note(`${count(card.position.length)} of ${count(card.targets)} targets are drawn, an even choice.`));
    node.append(...card.notes.map((text) => note(text)));
    grid.append(node);
  }
  body.append(grid);
  if (data.total > data.cards.length) body.append(note(`${count(data.total - data.cards.length)} more lines: their figures are in the text and the JSON of the comparison.`));
}

const withChoice = (body, data) => {
  const redraws = [];
  const names = data.cards[0].sources.slice(1).map((source) => source.name);
  const chosen = modelChoice(names, () => redraws.forEach((again) => again()));
  if (chosen.node) body.append(el('div', { class: 'controls' }, chosen.node));
  cards(body, data, chosen, redraws);
};

export function renderPositioning(body, data) {
  body.append(note('Deviation at the targets, actual minus commanded, towards + positive: means of the approaches from either side with ± 2 s, their mean, and what the model predicts there. Below: measured less predicted, on its own scale. A: accuracy, E: systematic deviation, R: repeatability, M: mean bidirectional deviation, B: reversal value. A figure that the readings do not define is a dash: repeatability needs two approaches from the same side.'));
  withChoice(body, data);
}

const groupsTable = (groups) => table([
  { name: 'Diagonals', align: 'left', cell: (row) => (row.first ? row.axes : '') },
  { name: 'Number', cell: (row) => (row.first ? row.number : '') },
  { name: '', align: 'left', cell: (row) => row.source.name },
  { name: 'E_d', unit: 'µm', cell: (row) => significant(row.source.E) },
  { name: 'B_d', unit: 'µm', cell: (row) => significant(row.source.B) },
], groups.flatMap((group) => group.sources.map((source, k) => ({ ...group, source, first: k === 0 }))), { caption: 'Figures of all diagonals, ISO 230-6' });

export function renderDiagonals(body, data) {
  body.append(
    note('Displacement along each diagonal, measured minus commanded, as the figures of ISO 230-2 with the diagonal in place of the axis; predicted beside measured, what remains below. E_d, B_d: the largest of all diagonals.'),
    groupsTable(data.groups),
  );
  withChoice(body, data);
}
