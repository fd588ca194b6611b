import { choice, decimalsFor, el, fixed, note, significant, symbolMark, table } from '../dom.js';
import { alongFigure, linesFigure, startFactors } from '../lenses/axis_lines.js';
import { addMotion, motionCaption, peakOf } from '../lenses/motion.js';
import { layerData, rotaryMapFigure } from '../lenses/rotary_map.js';
import { nameParts } from '../names.js';
import { addPlot, dropPlots, plain } from '../plot.js';
import { modelChoice } from './model_choice.js';

const kSceneHeight = 400;
const kAlongHeight = 380;

function motionPanel(motion) {
  const plot = el('div', { class: 'plot' });
  addMotion(plot, () => motion);
  return el('figure', { class: 'motion' }, [
    el('figcaption', {}, [
      symbolMark(motion.symbol, motion.axis), ` ${motionCaption(motion)}`, motion.visible ? el('span', { class: 'muted' }, `, peak ${fixed(peakOf(motion), 1)}`) : el('strong', {}, ' not visible'),
    ]),
    plot,
  ]);
}

function motionsOf(model) {
  const axes = [...new Set(model.motions.map(({ axis }) => axis))];
  return axes.flatMap((axis) => [
    el('h3', { class: `axis-${axis}` }, `Error motions of ${axis}`),
    ...model.carried.filter(({ carrying }) => carrying === axis).map(({ carried, motions }) => note(
      `One wave a turn of ${motions.join(' and ')} is also what a displacement of ${carried} along itself does: it turns with ${axis}, and no location error of ${carried} holds it.`,
    )),
    el('div', { class: 'motions' }, model.motions.filter((motion) => motion.axis === axis).map(motionPanel)),
  ]);
}

function linesTable(model) {
  const rows = model.lines.flatMap((line) => line.errors.map((error) => ({ ...error, axis: line.axis, along: line.along })));
  const measured = rows.filter(({ visible, by_convention: convention }) => visible && !convention);
  const decimals = Math.max(1, ...measured.map(({ U95 }) => decimalsFor(U95)));
  const number = (key) => (row) => (row.by_convention ? '–' : fixed(row[key], decimals));
  const state = (row) => (row.by_convention ? 'zero by convention' : row.visible ? '' : 'not visible');
  return table([
    { name: 'Error', align: 'left', cell: (row) => symbolMark(row.symbol, row.axis) },
    { name: 'Value', cell: number('value') },
    { name: 'U95', cell: number('U95') },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
    { name: '', align: 'left', cell: state },
  ], rows, { rowClass: (row) => (state(row) === '' ? null : 'dim'), caption: 'Axis average lines at machine zero' });
}

function factorSlider(label, factors, key, redraw) {
  const start = factors[key];
  const output = el('output', {});
  const input = el('input', { type: 'range', min: '-1', max: '1', step: '0.02', value: '0', 'aria-label': label });
  const show = () => { output.textContent = `${Number(factors[key].toPrecision(2)).toLocaleString('en-US')} ×`; };
  input.addEventListener('input', () => {
    factors[key] = start * 10 ** Number(input.value);
    show();
    redraw();
  });
  show();
  return el('label', { class: 'slider' }, [el('span', { class: 'muted' }, label), input, output]);
}

function linesOf(model) {
  if (model.lines.length === 0) return [];
  const factors = startFactors(model.lines, model.reach_mm);
  const scene = el('div', { class: 'plot scene' });
  const redraw = addPlot(scene, () => linesFigure(model.lines, model.reach_mm, factors, kSceneHeight));
  const views = model.lines.map((line) => {
    const plot = el('div', { class: 'plot' });
    addPlot(plot, () => alongFigure(line, kAlongHeight));
    return el('figure', {}, [el('figcaption', {}, [symbolMark(line.axis, line.axis), `, seen along ${line.along}: where its line passes, with 95 % ellipses; cross: nominal`]), plot]);
  });
  return [
    el('h3', {}, 'Axis average lines'),
    note(`Physical against nominal (dashed), machine coordinates at machine zero: errors of the axes that carry an axis are added to its own. Lines reach ${significant(model.reach_mm)} mm either way from the nominal centre.`),
    el('div', { class: 'controls' }, [factorSlider('Positions', factors, 'position', redraw), factorSlider('Directions', factors, 'direction', redraw)]),
    el('div', { class: 'pair lines' }, [
      el('figure', {}, [el('figcaption', {}, 'In space, exaggerated; points: the nominal centre, and where that went'), scene]),
      el('div', {}, linesTable(model)),
      ...views,
    ]),
  ];
}

function mapFigures(model, view) {
  const map = () => model.maps[view.tool];
  const parts = [['position', 'Position', 'µm'], ['orientation', 'Orientation', 'µrad']].map(([key, words, unit]) => {
    const plot = el('div', { class: 'plot' });
    const caption = el('figcaption');
    const layer = () => map()[key][view[key]];
    const describe = () => {
      const { largest, largest_U95: U95, at } = layerData(model.map_axes, layer(), unit);
      const where = model.map_axes.map((axis, k) => `${axis.name} ${fixed(at[k], 0)}°`).join(', ');
      caption.replaceChildren(`${words}, ${layer().name}: largest ${significant(largest)} ± ${significant(U95, 2)} ${unit} at ${where}`);
    };
    describe();
    const redraw = addPlot(plot, () => rotaryMapFigure(model.map_axes, layer(), unit));
    const names = map()[key].map(({ name }, k) => [k, name]);
    const control = choice(words, names, (value) => { view[key] = Number(value); describe(); redraw(); });
    return { node: el('figure', {}, [caption, plot]), control, again: () => { describe(); redraw(); } };
  });
  return parts;
}

function mapsOf(model) {
  const view = { tool: 0, position: 0, orientation: 0 };
  const place = el('p', { class: 'note' });
  const parts = mapFigures(model, view);
  const describe = () => {
    const { tool, point_mm: at } = model.maps[view.tool];
    const turning = model.map_axes.map(({ name }) => name).join(' and ');
    place.replaceChildren(`Tool ${tool} relative to the workpiece, workpiece coordinates: the tool point stays at ${at.map((v) => fixed(v, 0)).join(', ')} mm of the workpiece while ${turning} turn and the linear axes follow, of which no errors are counted. Dots: positions with readings.`);
  };
  describe();
  const tools = model.maps.length < 2 ? [] : [choice('Tool', model.maps.map(({ tool }, k) => [k, tool]), (value) => {
    view.tool = Number(value);
    describe();
    parts.forEach(({ again }) => again());
  })];
  return [
    el('h3', {}, `Error over ${model.map_axes.map(({ name }) => plain(name)).join(' and ')}`),
    place,
    el('div', { class: 'controls' }, [...tools, ...parts.map(({ control }) => control)]),
    el('div', { class: 'pair' }, parts.map(({ node }) => node)),
  ];
}

function show(body, model) {
  dropPlots(body);
  body.replaceChildren(
    note(`Error motions outwards positive about the circle of zero, with ${fixed(model.coverage, 2)} u band (95 %); tool relative to workpiece, in the directions of the axis that stands still. Dashed: beyond the measured positions.`),
    ...motionsOf(model), ...linesOf(model), ...mapsOf(model),
  );
}

export function renderRotaryAxes(body, data) {
  const part = el('div', {});
  const chosen = modelChoice(data.models.map(({ name }) => name), () => {
    show(part, data.models[chosen.index]);
    nameParts(part, 'Rotary axes');
  });
  if (chosen.node) body.append(el('div', { class: 'controls' }, chosen.node));
  body.append(part);
  show(part, data.models[chosen.index]);
}
