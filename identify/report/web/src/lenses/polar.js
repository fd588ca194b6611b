// A circle of the ball-bar: radial deviations over the angle, both ways round, about a base circle.
// data: { first, second, angle: degrees, sense: ±1, traces: [{ name, values: µm, dash, width, opacity, shade }] }.
// What is common to all polar plots is exported: rings, spokes and where a deviation lies.
import { addPlot, layout2d, plain } from '../plot.js';
import { el, significant } from '../dom.js';
import { color, series } from '../theme.js';

const kBase = 1; // radius of the base circle in the plot
const kReach = 0.62; // of the largest deviation
const kMostRings = 3; // each way
const kEdge = 1.12; // of the reach: where the axes end
const kGapDegrees = 25; // wider: nothing was read in between
export const kLimit = 1.13 * (kBase + kEdge * kReach); // of the axes of the plot

const kSenses = [[1, 'counter-clockwise', () => series(0), 'series-0'], [-1, 'clockwise', () => color('warning'), 'warning']];

/** The next of 1, 2, 2.5, 5, 10 ... above. */
function niceStep(value) {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 1e-9)));
  return [1, 2, 2.5, 5, 10].map((step) => step * power).find((step) => step >= value - 1e-12 * power);
}

export const largestDeviation = (traces) => Math.max(...traces.flatMap((trace) => trace.values.filter((v) => v !== null).map(Math.abs)), 1e-3);

const ringsOf = (traces) => ringsFor(largestDeviation(traces));

/** Distance of the rings for deviations up to `largest`, and how many there are either way. */
export function ringsFor(largest) {
  const step = niceStep(largest / kMostRings);
  return { step, count: Math.max(1, Math.ceil(largest / step - 1e-9)) };
}

const radians = (degrees) => (degrees * Math.PI) / 180;

/** One sense of one trace, with gaps where nothing was read. */
function path(data, values, wanted, scale) {
  const trace = { x: [], y: [], customdata: [] };
  let last = null;
  data.angle.forEach((angle, i) => {
    if (data.sense[i] !== wanted || values[i] === null) return;
    const turn = last === null ? 0 : Math.abs(((angle - last + 540) % 360) - 180);
    if (turn > kGapDegrees) {
      trace.x.push(null);
      trace.y.push(null);
      trace.customdata.push([null, null]);
    }
    const radius = kBase + kReach * (values[i] / scale);
    trace.x.push(radius * Math.cos(radians(angle)));
    trace.y.push(radius * Math.sin(radians(angle)));
    trace.customdata.push([(angle + 360) % 360, values[i]]);
    last = angle;
  });
  return trace;
}

/** Rings about the circle of zero; `sparse`: only the outermost and zero have their numbers. */
export function rings(scale, step, count, sparse = false) {
  const shapes = [];
  const annotations = [];
  for (let k = -count; k <= count; k += 1) {
    const radius = kBase + (kReach * k * step) / scale;
    shapes.push({
      type: 'circle', xref: 'x', yref: 'y', x0: -radius, x1: radius, y0: -radius, y1: radius, layer: 'below',
      line: { color: color(k === 0 ? 'zero' : 'grid'), width: k === 0 ? 1.4 : 1 },
    });
    if (sparse && k !== 0 && k !== count) continue;
    const at = radians(67.5);
    annotations.push({ x: radius * Math.cos(at), y: radius * Math.sin(at), text: k === 0 ? '0' : `${k > 0 ? '+' : '−'}${significant(Math.abs(k) * step, 2)}`, showarrow: false, font: { size: 10, color: color('muted') }, bgcolor: color('page'), borderpad: 1 });
  }
  return { shapes, annotations };
}

const axes = (data) => spokes([[0, `+${data.first}`], [90, `+${data.second}`], [180, `−${data.first}`], [270, `−${data.second}`]].map(([angle, text]) => [angle, text, color(`axis-${text.at(-1)}`)]));

/** Lines outwards with a text at their ends: [[angle, text, colour], ...]. */
export function spokes(ends) {
  const edge = kBase + kEdge * kReach;
  const inner = kBase - kReach;
  return {
    shapes: ends.map(([angle]) => ({
      type: 'line', x0: inner * Math.cos(radians(angle)), y0: inner * Math.sin(radians(angle)), x1: edge * Math.cos(radians(angle)), y1: edge * Math.sin(radians(angle)), line: { color: color('grid'), width: 1 }, layer: 'below',
    })),
    annotations: ends.map(([angle, text, shade]) => ({
      x: 1.08 * edge * Math.cos(radians(angle)), y: 1.06 * edge * Math.sin(radians(angle)), text, showarrow: false, font: { size: 12, color: shade },
    })),
  };
}

/** Where a deviation lies in the plot. */
export const placeOf = (scale) => (angle, value) => {
  const radius = kBase + kReach * (value / scale);
  return [radius * Math.cos(radians(angle)), radius * Math.sin(radians(angle))];
};

/** { limit: half the width of the plot, place(angle, value): [x, y] }. */
export function polarGeometry(traces) {
  const { step, count } = ringsOf(traces);
  return { limit: kLimit, place: placeOf(count * step) };
}

/** Layout of a polar plot; `limit`: half its width. */
export const polarLayout = (height, parts, limit = kLimit) => layout2d({
  height, margin: { l: 4, r: 4, t: 4, b: 4 }, hovermode: 'closest',
  x: { title: '', visible: false, range: [-limit, limit], fixedrange: true }, y: { title: '', visible: false, range: [-limit, limit], scaleanchor: 'x', fixedrange: true },
  shapes: parts.flatMap((part) => part.shapes), annotations: parts.flatMap((part) => part.annotations),
});

export function polarFigure(data, height) {
  const { step, count } = ringsOf(data.traces);
  const scale = count * step;
  const [ring, axis] = [rings(scale, step, count), axes(data)];
  const senses = kSenses.filter(([sense]) => data.sense.includes(sense));
  return {
    paperHeight: 0.8,
    data: senses.flatMap(([sense, words, shade]) => data.traces.map((trace) => ({
      ...path(data, trace.values, sense, scale), type: 'scatter', mode: 'lines', connectgaps: false, name: `${plain(trace.name)}, ${words}`,
      line: { color: trace.shade ? color(trace.shade) : shade(), width: trace.width ?? 1.5, dash: trace.dash ?? 'solid' }, opacity: trace.opacity ?? 1,
      hovertemplate: `${plain(trace.name)}, ${words}<br>%{customdata[0]:.1f}°: %{customdata[1]:.2f} µm<extra></extra>`,
    }))),
    layout: polarLayout(height, [axis, ring]),
  };
}

/** Height of a polar plot as wide as its place. */
export const polarHeight = (node, most = 430) => Math.round(Math.min(most, Math.max(280, node.clientWidth)));

/** Draws `make()` into `node`; the ring distance follows from the largest deviation. Returns a function that draws it again. */
export const addPolar = (node, make) => addPlot(node, () => polarFigure(make(), polarHeight(node)));

/** What a ring stands for, for the caption. */
export const ringStep = (traces) => ringsOf(traces).step;

const line = (style, text) => el('span', { class: 'key' }, [el('i', { class: 'line', style }), text]);

/** Legend of all circles of a section. */
export const polarLegend = () => el('div', { class: 'legend' }, [
  ...kSenses.map(([, words, , name]) => line(`border-top-color:var(--${name})`, words)),
  line('', 'measured'), line('border-top-style:dashed', 'predicted'),
]);
