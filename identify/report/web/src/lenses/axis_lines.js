// Average lines of rotary axes against their nominal places: in space, exaggerated, and seen along each axis in
// micrometres with 95 % ellipses. A line: { axis, along, across: ['X', 'Y'], centre_mm, displacement_um, rotation_urad,
// errors: [{ symbol, value, U95, unit, visible }], places: [{ along_mm, um: [u, v], covariance: [uu, uv, vv] }] }.
import { fixed, significant } from '../dom.js';
import { column, commonLayout, layout2d, legendAbove, norm, segments } from '../plot.js';
import { color, transparent } from '../theme.js';

const kComponents = ['X', 'Y', 'Z'];
const kEllipse = Math.sqrt(5.9915); // 95 % in two dimensions
const kShown = 0.3; // of the reach: how far the most displaced line is drawn from its nominal place
const kCamera = { eye: { x: 1.6, y: -2.1, z: 1.1 }, center: { x: 0, y: 0, z: -0.1 } };

const unit = (line) => kComponents.map((name) => (name === line.along ? 1 : 0));
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];

/** Round factor below `wanted`. */
function roundFactor(wanted) {
  const decade = 10 ** Math.floor(Math.log10(wanted));
  return decade * [5, 2, 1].find((step) => step * decade <= wanted);
}

/** What positions and directions are multiplied by at first, so that the largest of either shows. */
export function startFactors(lines, reach) {
  const largest = (values) => Math.max(1e-9, ...values);
  const position = largest(lines.map((line) => norm(line.displacement_um) * 1e-3));
  const direction = largest(lines.map((line) => reach * norm(cross(line.rotation_urad, unit(line))) * 1e-6));
  return { position: roundFactor((kShown * reach) / position), direction: roundFactor((kShown * reach) / direction) };
}

/** Ends of a line, actual and exaggerated, or nominal with factors of 0. */
function ends(line, reach, factors) {
  const turned = cross(line.rotation_urad, unit(line)).map((v) => v * 1e-6 * factors.direction);
  return [-1, 0, 1].map((side) => line.centre_mm.map((v, i) => v + line.displacement_um[i] * 1e-3 * factors.position + side * reach * (unit(line)[i] + turned[i])));
}

const numbers = (line) => line.errors.map(({ symbol, value, U95, unit: of }) => `${symbol} ${fixed(value, 1)} ± ${fixed(U95, 1)} ${of}`).join('<br>');

function lineTraces(line, reach, factors) {
  const hue = color(`axis-${line.axis}`);
  const nominal = ends(line, reach, { position: 0, direction: 0 });
  const actual = ends(line, reach, factors);
  const whole = (points) => segments([[points[0], points[2]]]);
  return [
    { ...whole(nominal), type: 'scatter3d', mode: 'lines', line: { color: color('muted'), width: 3, dash: 'dash' }, hoverinfo: 'skip' },
    { ...whole(actual), type: 'scatter3d', mode: 'lines', line: { color: hue, width: 7 }, hoverinfo: 'skip' },
    { ...segments([[nominal[1], actual[1]]]), type: 'scatter3d', mode: 'lines', line: { color: hue, width: 3 }, hoverinfo: 'skip' },
    {
      x: column([nominal[1], actual[1]], 0), y: column([nominal[1], actual[1]], 1), z: column([nominal[1], actual[1]], 2), type: 'scatter3d', mode: 'markers',
      marker: { size: [4, 5], color: [color('muted'), hue] }, text: [`nominal centre of ${line.axis}`, numbers(line)], hovertemplate: '%{text}<extra></extra>',
    },
    { x: [actual[2][0]], y: [actual[2][1]], z: [actual[2][2]], type: 'scatter3d', mode: 'text', text: [`+${line.along}, axis ${line.axis}`], textfont: { size: 13, color: hue }, textposition: 'top center', hoverinfo: 'skip' },
  ];
}

export function linesFigure(lines, reach, factors, height) {
  const axis = (name) => ({
    title: { text: `${name} [mm]`, font: { size: 11, color: color(`axis-${name}`) } }, color: color('muted'), gridcolor: color('grid'), zeroline: false, showbackground: false,
    tickfont: { size: 10 }, nticks: 5, showspikes: false,
  });
  return {
    paperHeight: 0.6,
    data: lines.flatMap((line) => lineTraces(line, reach, factors)),
    layout: {
      height, margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: 'rgba(0,0,0,0)', ...commonLayout(), showlegend: false, uirevision: 'keep',
      scene: { aspectmode: 'data', xaxis: axis('X'), yaxis: axis('Y'), zaxis: axis('Z'), camera: kCamera },
    },
  };
}

/** Points of a 95 % ellipse. */
function ellipse([x, y], [uu, uv, vv]) {
  const a = Math.sqrt(Math.max(uu, 1e-12));
  const b = uv / a;
  const c = Math.sqrt(Math.max(vv - b * b, 0));
  const turns = Array.from({ length: 49 }, (_, k) => (k * Math.PI) / 24);
  return { x: turns.map((t) => x + kEllipse * a * Math.cos(t)), y: turns.map((t) => y + kEllipse * (b * Math.cos(t) + c * Math.sin(t))) };
}

const placeName = (line, place) => (place.along_mm === 0 ? 'centre' : `${place.along_mm > 0 ? '+' : '−'}${line.along} ${significant(Math.abs(place.along_mm))} mm`);

/** One axis seen along itself: where its line passes at the centre and on either side, the nominal line being the point 0. */
export function alongFigure(line, height) {
  const hue = color(`axis-${line.axis}`);
  const shades = { '-1': 'circle-open', 0: 'circle', 1: 'triangle-up' };
  const places = line.places;
  const reach = Math.max(...places.flatMap(({ um: [x, y], covariance: [uu, , vv] }) => [Math.abs(x) + kEllipse * Math.sqrt(uu), Math.abs(y) + kEllipse * Math.sqrt(vv)]), 1e-3);
  const range = [-1.12 * reach, 1.12 * reach];
  const title = (k) => `${line.across[k]} [µm]`;
  return {
    paperHeight: 0.65,
    data: [
      { x: places.map(({ um }) => um[0]), y: places.map(({ um }) => um[1]), type: 'scatter', mode: 'lines', line: { color: hue, width: 2 }, hoverinfo: 'skip', showlegend: false },
      ...places.map((place) => ({ ...ellipse(place.um, place.covariance), type: 'scatter', mode: 'lines', fill: 'toself', fillcolor: transparent(hue, 0.16), line: { color: hue, width: 0.8 }, hoverinfo: 'skip', showlegend: false })),
      ...places.map((place) => ({
        x: [place.um[0]], y: [place.um[1]], type: 'scatter', mode: 'markers', name: placeName(line, place), marker: { size: 9, symbol: shades[Math.sign(place.along_mm)], color: hue, line: { width: 1.5, color: hue } },
        hovertemplate: `${placeName(line, place)}: ${line.across[0]} %{x:.2f}, ${line.across[1]} %{y:.2f} µm<extra></extra>`,
      })),
      { x: [0], y: [0], type: 'scatter', mode: 'markers', showlegend: false, marker: { size: 12, symbol: 'cross-thin', line: { width: 2, color: color('text') } }, hovertemplate: 'nominal line<extra></extra>' },
    ],
    layout: layout2d({ height, ...legendAbove(), margin: { t: 44 }, hovermode: 'closest', x: { title: title(0), range, constrain: 'domain' }, y: { title: title(1), range, scaleanchor: 'x', constrain: 'domain' } }),
  };
}
