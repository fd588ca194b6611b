import { count, el, fixed, note, significant, table } from '../dom.js';
import { addDrift } from '../lenses/drift.js';
import { addTurn } from '../lenses/motion.js';
import { modelChoice } from './model_choice.js';

const kMotionFigures = [['total', 'total'], ['synchronous', 'synchronous'], ['asynchronous', 'asynchronous'], ['fundamental', 'one wave a turn']];

function motionFigure(test, chosen) {
  const predicted = () => test.sources[1 + chosen()];
  const plot = el('div', { class: 'plot' });
  const redraw = addTurn(plot, () => ({
    angle: test.angle, unit: test.unit, traces: [{ name: 'measured', values: test.sources[0].value, dash: 'solid' }, { name: predicted().name, values: predicted().value, dash: 'dash' }],
  }));
  const figures = el('div', {});
  const fill = () => figures.replaceChildren(table([
    { name: '', align: 'left', cell: ([, words]) => words },
    { name: 'Measured', unit: test.unit, cell: ([key]) => significant(test.sources[0][key]) },
    { name: 'Predicted', unit: test.unit, cell: ([key]) => significant(predicted()[key]) },
  ], kMotionFigures, { className: 'card-figures', caption: `Figures of ISO 230-7, axis ${test.axis}, ${test.motion}, ${test.setup}` }));
  fill();
  const node = el('figure', { class: 'motion' }, [
    el('figcaption', {}, [el('strong', { class: `axis-${test.axis}` }, test.axis), ` ${test.motion} (${test.setup})`]), plot, figures, ...test.notes.map((text) => note(text)),
  ]);
  return { node, again: () => { fill(); redraw(); } };
}

function driftTable(drifts) {
  const rows = drifts.flatMap((test) => test.sources.map((source, k) => ({ ...test, ...source, first: k === 0 })));
  return table([
    { name: 'Drift', align: 'left', cell: (row) => `${row.drift} (${row.setup})` },
    { name: '', align: 'left', cell: (row) => row.name },
    { name: 'Time', unit: 'h', cell: (row) => fixed(row.hours, 1) },
    { name: 'Range', cell: (row) => significant(row.range) },
    { name: 'First hour', cell: (row) => significant(row.first_hour) },
    { name: 'Any hour', cell: (row) => significant(row.any_hour) },
    { name: 'Change', cell: (row) => significant(row.change) },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
    { name: 'Temperatures', align: 'left', cell: (row) => (row.first ? row.temperatures : '') },
  ], rows, { caption: 'Drift at rest' });
}

export function renderDirectTests(body, data) {
  if (data.motions.length > 0) {
    const parts = [];
    const chosen = modelChoice(data.motions[0].sources.slice(1).map(({ name }) => name), () => parts.forEach(({ again }) => again()));
    parts.push(...data.motions.map((test) => motionFigure(test, () => chosen.index)));
    body.append(
      note('One rotary axis turns alone: displacements of a sphere on it, in the directions of the body that carries the axis; outwards positive, measured with dots, predicted dashed. Radial and tilt error motion about the least-squares centre, which takes out the eccentricity of the sphere, axial about its mean. Total: range of all readings; synchronous: of their means at every angle; asynchronous: largest range at one angle.'),
    );
    if (chosen.node) body.append(el('div', { class: 'controls' }, chosen.node));
    body.append(el('div', { class: 'motions turns' }, parts.map(({ node }) => node)));
    if (data.total > data.motions.length) body.append(note(`${count(data.total - data.motions.length)} more: their figures are in the text and the JSON of the comparison.`));
  }
  if (data.drifts.length > 0) {
    const redraws = [];
    const chosen = modelChoice(data.drifts[0].sources.slice(1).map(({ name }) => name), () => redraws.forEach((again) => again()));
    const cards = data.drifts.map((test) => {
      const plot = el('div', { class: 'plot' });
      redraws.push(addDrift(plot, test, () => chosen.index));
      return el('figure', { class: 'card' }, [el('figcaption', {}, [el('strong', {}, test.drift), ` (${test.setup})`]), plot]);
    });
    body.append(el('h3', {}, 'Drift at rest'), note('Nothing moves: curves over time less the first reading, measured and predicted; range of the readings over the whole time, in the first hour, in any one hour, and the last less the first.'));
    if (chosen.node) body.append(el('div', { class: 'controls' }, chosen.node));
    body.append(el('div', { class: 'pair cards' }, cards), driftTable(data.drifts), ...[...new Set(data.drifts.flatMap(({ notes }) => notes))].map((text) => note(text)));
  }
}
