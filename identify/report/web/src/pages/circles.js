import { count, el, fixed, note, significant, table } from '../dom.js';
import { addPolar, polarLegend, ringStep } from '../lenses/polar.js';
import { modelChoice } from './model_choice.js';

const measuredTraces = (circle, model) => [
  { name: 'measured', values: circle.measured, opacity: 0.75 },
  { name: 'predicted', values: model.predicted, dash: '5px,3px', width: 2.2 },
];
const residualTraces = (circle, model) => [{ name: 'measured less predicted', values: circle.measured.map((value, i) => (value === null || model.predicted[i] === null ? null : value - model.predicted[i])) }];

const polarData = (circle, traces) => ({ first: circle.first, second: circle.second, angle: circle.angle, sense: circle.sense, traces });

function figuresTable(circle, model) {
  const rows = [
    ['G counter-clockwise', (f) => f.ccw?.G], ['G clockwise', (f) => f.cw?.G], ['G(b), both ways', (f) => f.G_both],
    ['F counter-clockwise', (f) => (f.ccw ? [f.ccw.F_min, f.ccw.F_max] : null)], ['F clockwise', (f) => (f.cw ? [f.cw.F_min, f.cw.F_max] : null)],
    ['D, mean radial', (f) => f.D], [`B of ${circle.first}`, (f) => f.B_first], [`B of ${circle.second}`, (f) => f.B_second],
  ];
  const shown = (value) => (Array.isArray(value) ? value.map((v) => significant(v)).join(' … ') : significant(value));
  return table([
    { name: '', align: 'left', cell: ([name]) => name },
    { name: 'Measured', unit: 'µm', cell: ([, of]) => shown(of(circle.figures)) },
    { name: 'Predicted', unit: 'µm', cell: ([, of]) => shown(of(model.figures)) },
  ], rows, { caption: `Figures of ISO 230-4, ${circle.setup}` });
}

function causesTable(circle, model) {
  const { rows, others, others_share: rest } = model.causes;
  if (rows.length === 0) return note('The model predicts no deviation from the circle.');
  return el('div', {}, [
    table([
      { name: 'Cause', align: 'left', cell: (row) => row.name },
      { name: 'Range', unit: 'µm', cell: (row) => significant(row.range) },
      { name: '± U95', unit: 'µm', cell: (row) => significant(row.U95, 2) },
      { name: 'Share', unit: '%', cell: (row) => fixed(100 * row.share, 1) },
    ], rows, { caption: `What the model predicts comes from, ${circle.setup}` }),
    others > 0 ? note(`${count(others)} more: ${fixed(100 * rest, 1)} % together.`) : null,
  ]);
}

function circleCard(circle, chosen) {
  const model = () => circle.models[chosen()];
  const nodes = [el('div', { class: 'plot' }), el('div', { class: 'plot' })];
  const captions = [el('figcaption'), el('figcaption')];
  const figures = el('div', {});
  const describe = () => {
    captions[0].replaceChildren(`Measured and predicted; rings ${significant(ringStep(measuredTraces(circle, model())), 2)} µm apart`);
    captions[1].replaceChildren(`What remains: RMS ${significant(model().residual_rms)} µm; rings ${significant(ringStep(residualTraces(circle, model())), 2)} µm apart`);
    figures.replaceChildren(figuresTable(circle, model()), causesTable(circle, model()));
  };
  describe();
  const redraws = [
    addPolar(nodes[0], () => polarData(circle, measuredTraces(circle, model()))),
    addPolar(nodes[1], () => polarData(circle, residualTraces(circle, model()))),
  ];
  const card = el('div', { class: 'circle-card' }, [
    el('h3', {}, `${circle.setup}: plane ${circle.first}${circle.second}, radius ${significant(circle.radius_mm, 4)} mm, ${count(circle.readings)} readings`),
    el('div', { class: 'circle' }, [...nodes.map((node, k) => el('figure', {}, [captions[k], node])), figures]),
    circle.drawn < circle.readings ? note(`${count(circle.drawn)} of ${count(circle.readings)} readings are drawn, the largest and the smallest of every piece of the path.`) : null,
    circle.least_squares_centre ? null : note('Part of a circle: deviations are about the centre of the instrument as set up.'),
    ...circle.notes.map((text) => note(text)),
  ]);
  return { card, redraw: () => { describe(); redraws.forEach((again) => again()); } };
}

export function renderCircles(body, data) {
  const cards = [];
  const names = data.circles[0].models.map((model) => model.name);
  const chosen = modelChoice(names, () => cards.forEach(({ redraw }) => redraw()));
  body.append(note('Radial deviation from the nominal circle, outwards positive, about the least-squares centre of the readings of both ways round; predictions about the same centre. G: range about a way’s own circle, F: deviations of the radius, D: mean radius of both ways, B: reversal at the quadrants. Causes: what each error of the model makes of the radius round the circle, centre and mean radius taken out; their shares of the predicted mean square sum to 100 %, a negative one cancels part of the others. Range ± U95: from its lowest to its highest point.'));
  body.append(el('div', { class: 'controls' }, [chosen.node, polarLegend()]));
  for (const circle of data.circles) {
    cards.push(circleCard(circle, () => chosen.index));
    body.append(cards.at(-1).card);
  }
  if (data.total > data.circles.length) body.append(note(`${count(data.total - data.circles.length)} more circles: their figures are in the text and the JSON of the comparison.`));
}
