// A function without a formula: heat map with its readings and cuts with their bands, or a curve with its band.
import { decimalsFor, el, fixed, note, significant } from '../dom.js';
import { addPlot, colorBar, layout2d, legendAbove, plain } from '../plot.js';
import { color, series, transparent } from '../theme.js';

const kBands = 12; // of the heat map, so that their edges are contours
const kPixels = 12; // of the picture, between neighbouring places

const kUnnamed = 'What has no name, as the readings show it';

/** "11.0 ± 2.1": as many decimals as two digits of U have. */
const withU = (value, U95) => (U95 > 0 ? `${fixed(value, decimalsFor(U95))} ± ${fixed(U95, decimalsFor(U95))}` : significant(value, 3));

const unitBehind = (unit) => (unit ? ` ${unit}` : '');

const largest = (values) => Math.max(...values.map(Math.abs), 1e-12);

/** Value in −1..1 as a colour: one hue below zero, another above, the page's colour at zero. */
function shade(share, rgb) {
  const strong = share < 0 ? rgb.below : rgb.above;
  const weight = Math.abs(share);
  return strong.map((v, i) => Math.round(weight * v + (1 - weight) * rgb.page[i]));
}

const channels = (hex) => [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16));
const palette = () => ({ below: channels(color('series-0')), above: channels(color('bad')), page: channels(color('page')) });

/** Filled contours of values on a grid, as a picture; sizes, which are never negative, have twice the bands. */
function picture(data, limit) {
  const bands = data.isSize ? kBands : kBands / 2;
  const [x, y] = data.axes.map((axis) => axis.places.length);
  const canvas = document.createElement('canvas');
  canvas.width = (x - 1) * kPixels;
  canvas.height = (y - 1) * kPixels;
  const context = canvas.getContext('2d');
  const image = context.createImageData(canvas.width, canvas.height);
  const rgb = palette();
  const value = (i, j) => data.value[i * y + j];
  for (let row = 0; row < canvas.height; row += 1) {
    const v = (canvas.height - row - 0.5) / kPixels;
    const j = Math.min(y - 2, Math.floor(v));
    for (let column = 0; column < canvas.width; column += 1) {
      const u = (column + 0.5) / kPixels;
      const i = Math.min(x - 2, Math.floor(u));
      const [a, b] = [u - i, v - j];
      const here = (1 - a) * ((1 - b) * value(i, j) + b * value(i, j + 1)) + a * ((1 - b) * value(i + 1, j) + b * value(i + 1, j + 1));
      const band = Math.round((here / limit) * bands) / bands;
      image.data.set([...shade(Math.max(-1, Math.min(1, band)), rgb), 255], 4 * (row * canvas.width + column));
    }
  }
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}

function scale(isSize) {
  const rgb = palette();
  return [0, 0.25, 0.5, 0.75, 1].map((at) => [at, `rgb(${shade(isSize ? at : 2 * at - 1, rgb).join(',')})`]);
}

/** Where the label of a place stands, so that it stays on the map: below what is high up, inwards at the sides. */
function labelAt(axes, at) {
  const [u, v] = axes.map((axis, i) => (at[i] - axis.places[0]) / (axis.places.at(-1) - axis.places[0]));
  return { ax: 0, ay: v > 0.85 ? 26 : -26, xanchor: u > 0.8 ? 'right' : u < 0.2 ? 'left' : 'center' };
}

/** Values on a grid of two variables, with the places of the readings. */
export function heatMap(data, height = 560) {
  const [x, y] = data.axes;
  const limit = data.scale ?? largest(data.value);
  const worded = (value, U95) => `${withU(value, U95)} ${plain(data.unit)}`;
  const hover = x.places.flatMap((u) => y.places.map((v) => [u, v]));
  const ends = (axis) => [axis.places[0], axis.places.at(-1)];
  return {
    data: [
      {
        x: hover.map(([u]) => u), y: hover.map(([, v]) => v), type: 'scatter', mode: 'markers', showlegend: false,
        marker: { size: 9, opacity: 0, color: data.value, colorscale: scale(data.isSize), cmin: data.isSize ? 0 : -limit, cmax: limit, showscale: true, colorbar: colorBar(plain(data.unit), 1.01) },
        text: data.value.map((value, k) => worded(value, data.U95?.[k])),
        hovertemplate: `${plain(x.name)} %{x:.4g}, ${plain(y.name)} %{y:.4g}: %{text}<extra></extra>`,
      },
      { x: x.dots, y: y.dots, type: 'scatter', mode: 'markers', name: 'readings', marker: { size: 2.5, color: color('muted'), opacity: 0.7 }, hoverinfo: 'skip' },
      {
        x: [data.at[0]], y: [data.at[1]], type: 'scatter', mode: 'markers', name: 'largest', visible: !data.quiet, marker: { size: 11, symbol: 'circle-open', line: { width: 2 }, color: color('text') }, hoverinfo: 'skip',
      },
    ],
    layout: layout2d({
      height, margin: { r: 70, t: 24 }, hovermode: 'closest',
      annotations: data.quiet ? [] : [{
        x: data.at[0], y: data.at[1], ...labelAt(data.axes, data.at), arrowhead: 0, arrowcolor: color('text'), bgcolor: color('page'), font: { size: 12, color: color('text') },
        text: worded(data.largest, data.largest_U95),
      }],
      x: { title: plain(x.title), range: ends(x), showgrid: false, zeroline: false }, y: { title: plain(y.title), range: ends(y), showgrid: false, zeroline: false },
      images: [{ source: picture(data, limit), xref: 'x', yref: 'y', x: ends(x)[0], y: ends(y)[1], sizex: ends(x)[1] - ends(x)[0], sizey: ends(y)[1] - ends(y)[0], sizing: 'stretch', layer: 'below' }],
    }),
  };
}

const nearest = (places, at) => places.reduce((best, place, k) => (Math.abs(place - at) < Math.abs(places[best] - at) ? k : best), 0);

/** A line with its 95 % band. */
function banded(places, values, bands, hue, name) {
  return [
    {
      x: [...places, ...[...places].reverse()], y: [...values.map((v, k) => v + bands[k]), ...values.map((v, k) => v - bands[k]).reverse()],
      type: 'scatter', mode: 'lines', fill: 'toself', fillcolor: transparent(hue, 0.16), line: { width: 0 }, hoverinfo: 'skip', showlegend: false,
    },
    { x: places, y: values, type: 'scatter', mode: 'lines', line: { color: hue, width: 2 }, name, hovertemplate: `%{x:.4g}: %{y:.3g}<extra>${name}</extra>` },
  ];
}

/** Along one axis, at the place of the largest value and near both ends of the other. */
function cuts(data, along) {
  const other = 1 - along;
  const [axis, across] = [data.axes[along], data.axes[other]];
  const y = data.axes[1].places.length;
  const last = across.places.length - 1;
  const chosen = [...new Set([nearest(across.places, data.at[other]), Math.round(0.15 * last), Math.round(0.85 * last)])];
  const index = (k, m) => (along === 0 ? k * y + m : m * y + k);
  return {
    data: chosen.flatMap((m, n) => banded(
      axis.places, axis.places.map((_, k) => data.value[index(k, m)]), axis.places.map((_, k) => data.U95[index(k, m)]),
      series(n), `${plain(across.name)} = ${significant(across.places[m], 3)}`,
    )),
    layout: layout2d({ height: 260, ...legendAbove(), margin: { t: 30 }, hovermode: 'closest', x: { title: plain(axis.title) }, y: { title: `${plain(data.target)} [${plain(data.unit)}]` } }),
  };
}

/** Values along one variable with their band. */
export function curve(data) {
  const [axis] = data.axes;
  return {
    data: [
      ...banded(axis.places, data.value, data.U95 ?? data.value.map(() => 0), color('bad'), data.U95 ? '± U95' : data.target),
      { x: axis.dots, y: axis.dots.map(() => 0), type: 'scatter', mode: 'markers', name: 'readings', marker: { size: 5, symbol: 'line-ns-open', color: color('muted') }, hoverinfo: 'skip' },
    ],
    layout: layout2d({ height: 320, ...legendAbove(), margin: { t: 30 }, hovermode: 'closest', x: { title: plain(axis.title) }, y: { title: `${plain(data.target)} [${plain(data.unit)}]` } }),
  };
}

/** The pictures of a surface or curve, largest first: [{ caption, make }]. */
export function surfaceFigures(data, title = kUnnamed) {
  const where = data.third ? `, at ${data.third} = ${significant(data.third_at, 3)}${unitBehind(data.third_unit)}` : '';
  const whole = { caption: `${title}${where}`, make: () => (data.axes.length === 1 ? curve(data) : heatMap(data)) };
  const others = data.axes.length === 1 ? [] : [0, 1].map((along) => ({ caption: `Cuts along ${data.axes[along].name}, 95 % bands`, make: () => cuts(data, along) }));
  return [whole, ...others];
}

function plotOf({ make, caption }) {
  const node = el('div', { class: 'plot' });
  addPlot(node, make);
  return el('figure', {}, [el('figcaption', {}, caption), node]);
}

const place = (data) => [...data.axes, ...(data.third ? [{ name: data.third, unit: data.third_unit }] : [])]
  .map(({ name, unit }, i) => `${name} = ${significant(data.at[i], 3)}${unitBehind(unit)}`).join(', ');

/** Its largest value, its picture and its cuts. `over`: what its RMS is taken over; `title`: of the picture. */
export function drawSurface(body, data, { over, title }) {
  const times = data.factor === '' ? '' : `, times ${data.factor}`;
  body.append(el('p', { class: 'surface' }, [
    el('strong', {}, data.label), `: up to ${withU(data.largest, data.largest_U95)} ${data.unit} (95 %) at ${place(data)}${times}; RMS over ${over} ${significant(data.rms, 2)} ${data.unit}.`,
  ]));
  const [whole, ...cutsAlong] = surfaceFigures(data, title).map(plotOf);
  body.append(cutsAlong.length === 0 ? whole : el('div', { class: 'pair' }, [whole, el('div', { class: 'cuts' }, cutsAlong)]));
}

/** One that a diagnosis has drawn, with its laws. */
export function renderSurface(body, data) {
  drawSurface(body, data, { over: 'the readings', title: kUnnamed });
  for (const [k, formula] of data.formulas.entries()) {
    body.append(el('p', {}, [k === 0 ? 'A law that explains as much: ' : 'Or: ', el('strong', {}, formula.label), formula.shape === '' ? '' : `, ${formula.shape}`, `: ${withU(formula.amplitude, formula.U95)} ${formula.unit}.`]));
  }
  const open = data.free.length > 0 ? ` These readings leave open ${data.free.join('; ')}.` : '';
  body.append(note(`A smooth function found by the readings alone: they determine about ${significant(data.effective_parameters, 2)} of its parameters.${open} ${data.formulas.length > 0 ? 'extended.toml holds the law as an effect of the kind custom.' : 'extended.toml holds it as an effect of the kind empirical.'}`));
}
