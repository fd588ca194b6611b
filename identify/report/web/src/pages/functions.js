import { choice, el, fixed, note, symbolMark } from '../dom.js';
import { addPlot, layout2d } from '../plot.js';
import { color, transparent } from '../theme.js';

/** Continuous stretches of equal flag, each reaching to the first point of the next one. */
function stretches(flags) {
  const list = [];
  for (let i = 0; i < flags.length; ++i) {
    if (i === 0 || flags[i] !== flags[i - 1]) list.push({ flag: flags[i], from: i, to: i });
    list.at(-1).to = Math.min(i + 1, flags.length - 1);
  }
  return list;
}

function bandTrace(f, curve, shade) {
  const upper = curve.value.map((v, i) => v + curve.U95[i]);
  const lower = curve.value.map((v, i) => v - curve.U95[i]);
  return {
    x: [...f.position, ...f.position.slice().reverse()], y: [...upper, ...lower.reverse()],
    type: 'scatter', mode: 'lines', line: { width: 0 }, fill: 'toself', fillcolor: transparent(shade, 0.2), hoverinfo: 'skip',
  };
}

const dashOf = { '-1': 'dot', 0: 'solid', 1: 'dash' };
const approach = { '-1': ' (approach −)', 0: '', 1: ' (approach +)' };

function lineTraces(f, curve, unit, line) {
  const hover = `${f.axis} %{x:.1f} ${unit}<br><b>${f.symbol}</b> %{y:.2f} ± %{customdata:.2f} ${f.unit}${approach[curve.direction]}`;
  return stretches(f.extrapolated).map(({ flag, from, to }) => ({
    x: f.position.slice(from, to + 1), y: curve.value.slice(from, to + 1), customdata: curve.U95.slice(from, to + 1),
    type: 'scatter', mode: 'lines',
    line: { color: line, width: flag ? 1.2 : 1.8, dash: flag ? 'dash' : dashOf[curve.direction] },
    hovertemplate: `${hover}${flag ? '<br>extrapolated' : ''}<extra></extra>`,
  }));
}

/** Grey ground where nothing was measured. */
const extrapolatedShapes = (f) => stretches(f.extrapolated).filter((part) => part.flag).map((part) => ({
  type: 'rect', xref: 'x', yref: 'paper', x0: f.position[part.from], x1: f.position[part.to], y0: 0, y1: 1,
  fillcolor: transparent(color('muted'), 0.12), line: { width: 0 }, layer: 'below',
}));

const knotShapes = (f) => f.knots.map((q) => ({
  type: 'line', xref: 'x', yref: 'paper', x0: q, x1: q, y0: 0, y1: 0.045, line: { color: color('muted'), width: 1 },
}));

const reach = (f) => Math.max(...f.curves.flatMap((c) => c.value.map((v, i) => Math.abs(v) + c.U95[i])));

function functionPlot(f, axis, view, functions) {
  const visible = f.state === 'identified';
  const shade = visible ? color(`axis-${f.axis}`) : color('muted');
  const y = { title: f.unit, nticks: 5 };
  if (view.scale === 'same') {
    const peers = functions.filter((g) => g.state === 'identified' && g.unit === f.unit);
    const limit = 1.05 * Math.max(0, ...peers.map(reach));
    if (limit > 0) y.range = [-limit, limit];
  }
  return {
    data: f.curves.flatMap((curve) => [bandTrace(f, curve, shade), ...lineTraces(f, curve, axis.unit, shade)]),
    layout: layout2d({
      height: 176, x: { title: `${f.axis} [${axis.unit}]`, range: axis.range, nticks: 6, zeroline: false }, y: { ...y, title: `[${f.unit}]` },
      shapes: [...extrapolatedShapes(f), ...knotShapes(f)], hovermode: 'closest', hoverdistance: 40, margin: { l: 44, t: 4, b: 36 },
    }),
  };
}

function largest(f) {
  let best = 0;
  for (const curve of f.curves) {
    curve.value.forEach((v, i) => { if (!f.extrapolated[i] && Math.abs(v) > Math.abs(best)) best = v; });
  }
  return best;
}

function panel(f, axis, view, functions, redraws) {
  const head = el('figcaption', {}, [symbolMark(f.symbol, f.axis), el('span', { class: 'muted' }, ` ${f.meaning}`)]);
  if (f.state === 'off') {
    return el('figure', { class: 'panel empty' }, [head, el('p', { class: 'muted' }, 'Left out of the model: zero.')]);
  }
  if (f.state === 'identified') head.append(el('span', { class: 'peak muted' }, `peak ${fixed(largest(f), 1)} ${f.unit}`));
  const plot = el('div', { class: 'plot' });
  const node = el('figure', { class: `panel ${f.state}` }, [head, plot]);
  if (f.state === 'invisible') {
    node.append(el('p', { class: 'reason' }, [el('strong', {}, 'Not visible: '), f.reason]));
  }
  redraws.push(addPlot(plot, () => functionPlot(f, axis, view, functions)));
  return node;
}

/** Linear axes in one row, those parallel to them and rotary axes in others, three at most. */
function rowsOf(all) {
  const rows = [];
  for (const [kind, letters] of [['linear', 'XYZ'], ['linear', 'UVW'], ['rotary', 'ABC']]) {
    const axes = all.filter(({ name }) => letters.includes(name));
    for (let first = 0; first < axes.length; first += 3) rows.push([kind, axes.slice(first, first + 3)]);
  }
  return rows;
}

export function renderFunctions(body, data) {
  const view = { scale: 'own' };
  const redraws = [];
  const controls = el('div', { class: 'controls' }, choice('Scale', [['own', 'of each function'], ['same', 'same for all']], (value) => {
    view.scale = value;
    redraws.forEach((redraw) => redraw());
  }));
  body.append(note(`Value and ${fixed(data.coverage, 2)} u band (95 %) along each axis. Dashed on grey ground: extrapolated beyond the measured positions. Ticks on the position axis: ends of the pieces of the function.`), controls);
  for (const [kind, axes] of rowsOf(data.axes)) {
    const grid = el('div', { class: `functions ${kind}`, style: `--columns:${axes.length}` });
    for (const axis of axes) {
      grid.append(el('h3', { class: `axis-${axis.name}` }, `${axis.name} axis`));
      for (let component = 0; component < 6; ++component) {
        const f = data.functions.find((g) => g.axis === axis.name && g.component === component);
        grid.append(panel(f, axis, view, data.functions, redraws));
      }
    }
    body.append(grid);
    if (kind === 'rotary') body.append(el('p', { class: 'note paper-only' }, `Error functions of ${axes.map(({ name }) => name).join(', ')}: under “Rotary axes”, where they were identified.`));
  }
}
