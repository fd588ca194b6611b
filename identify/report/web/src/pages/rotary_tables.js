// Tables of rotary axes: what they add to the commands as an axis turns, and the error without and with them.
import { el, fixed, note, significant, symbolMark } from '../dom.js';
import { rotaryMapFigure } from '../lenses/rotary_map.js';
import { addPlot, layout2d, legendAbove } from '../plot.js';
import { color } from '../theme.js';

const kCurveHeight = 230;
const kMapHeight = 360;

const sizeOf = (values) => Math.max(0, ...values.map(Math.abs));

function curvesFigure(added, curves, unit) {
  const positions = added.position;
  return {
    data: curves.map(({ name, value, hue, dash }) => ({
      x: positions, y: value, type: 'scatter', mode: 'lines', name, line: { color: color(hue), width: 2, dash },
      hovertemplate: `${added.axis} %{x:.1f}°: %{y:.3g} ${unit}<extra>${name}</extra>`,
    })),
    layout: layout2d({
      height: kCurveHeight, ...legendAbove(), margin: { t: 26 }, hovermode: 'closest',
      x: { title: `${added.axis} [°]`, range: [positions[0], positions.at(-1)], zeroline: false }, y: { title: `[${unit}]`, nticks: 6 },
    }),
  };
}

function addedFigure(added, words, curves, unit) {
  const plot = el('div', { class: 'plot low' });
  addPlot(plot, () => curvesFigure(added, curves, unit));
  const most = sizeOf(curves.flatMap(({ value }) => value));
  return el('figure', {}, [
    el('figcaption', {}, [symbolMark(added.axis, added.axis), ` turns: ${words}, at most ${significant(most)} ${unit}`]), plot,
  ]);
}

const kNothing = 0.01; // µm or µrad

const largestOf = (values, unit) => (sizeOf(values) < kNothing ? `below ${kNothing} ${unit}` : `largest ${significant(sizeOf(values))} ${unit}`);

/** An axis that no table turns has no such curve. */
function addedOf(added) {
  const dashes = ['solid', 'dash', 'dot'];
  const moved = added.moved.map(({ axis, value }, k) => ({ name: axis, value, hue: `axis-${axis}`, dash: dashes[k] }));
  const figures = [];
  if (sizeOf(added.turned) > 0) figures.push(addedFigure(added, `added to ${added.axis} itself`, [{ name: added.axis, value: added.turned, hue: `axis-${added.axis}` }], 'µrad'));
  if (sizeOf(moved.flatMap(({ value }) => value)) > 0) figures.push(addedFigure(added, 'added to X, Y, Z', moved, 'µm'));
  return figures;
}

/** Both maps of a kind have one scale, so that what is left shows small. */
function mapOf(data, key, title, unit) {
  const scale = sizeOf([...data.before[key], ...data.left[key]]);
  return ['before', 'left'].map((which) => {
    const value = data[which][key];
    const plot = el('div', { class: 'plot' });
    const axes = data.map_axes.map((axis) => ({ ...axis, dots: [] }));
    addPlot(plot, () => rotaryMapFigure(axes, { name: title, value, scale, quiet: sizeOf(value) < kNothing }, unit, kMapHeight));
    const words = which === 'before' ? 'without the tables' : 'with the tables';
    return el('figure', {}, [el('figcaption', {}, `${title}, ${words}: ${largestOf(value, unit)}`), plot]);
  });
}

export function renderRotaryTables(body, data) {
  if (data.alone) document.documentElement.classList.add('pictured');
  const turning = data.map_axes.map(({ name }) => name).join(' and ');
  body.append(
    note(`${data.format} ${data.type}, tool ${data.tool}, as the controller reads the tables: corrections for the errors of rotary axes alone. The tool point stays at ${data.point_mm.map((v) => fixed(v, 0)).join(', ')} mm of the workpiece while the axes turn and the linear axes follow.`),
    el('h3', {}, 'What the tables add to the commands'),
    el('div', { class: 'pair' }, data.axes.flatMap(addedOf)),
    el('h3', {}, `Error of the rotary axes over ${turning}`),
    el('div', { class: 'pair' }, [...mapOf(data, 'position', 'Tool point', 'µm'), ...mapOf(data, 'orientation', 'Direction of the tool axis', 'µrad')]),
  );
}
