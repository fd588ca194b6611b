import { choice, el, fixed, note, table } from '../dom.js';
import { addPlot, colorBar, column, commonLayout, norm, plain, plainInScene, sceneHeight, segments, sizeShades } from '../plot.js';
import { color, instrumentIndex, series, transparent } from '../theme.js';

const kComponents = ['x', 'y', 'z'];

function edges(corners) {
  const pairs = [];
  for (let a = 0; a < corners.length; ++a) {
    for (let bit = 1; bit < corners.length; bit <<= 1) {
      if (!(a & bit)) pairs.push([corners[a], corners[a | bit]]);
    }
  }
  return pairs;
}

const boxTrace = (tool) => ({
  ...segments(edges(tool.corner_mm)), type: 'scatter3d', mode: 'lines', line: { color: color('muted'), width: 1.5 },
  hoverinfo: 'skip', name: 'work volume', showlegend: false,
});

const place = (tool, k) => `at ${tool.point_mm[k].map((v) => fixed(v, 0)).join(', ')} mm${tool.extrapolated[k] ? ', extrapolated' : ''}`;

/** Arrows from the nominal points; both pictures have the shades of the errors before. */
function vectorTraces(tool, vectors, textOf, magnification) {
  const size = vectors.map(norm);
  const tip = tool.point_mm.map((p, k) => p.map((v, i) => v + magnification * 1e-3 * vectors[k][i]));
  const shades = size.flatMap((s) => [s, s, s]);
  const scale = sizeShades(tool.error_max_um);
  return [
    { ...segments(tool.point_mm.map((p, k) => [p, tip[k]])), type: 'scatter3d', mode: 'lines', line: { width: 5, color: shades, ...scale }, hoverinfo: 'skip', showlegend: false },
    {
      x: column(tip, 0), y: column(tip, 1), z: column(tip, 2), text: vectors.map((_, k) => textOf(k)), type: 'scatter3d', mode: 'markers', showlegend: false,
      marker: { size: 2, color: size, ...scale, colorbar: colorBar('|E| [µm]', 0.88) }, hovertemplate: '%{text}<extra></extra>',
    },
  ];
}

const beforeTraces = (tool, magnification) => vectorTraces(tool, tool.error_um, (k) => {
  const [x, y, z] = tool.error_um[k].map((v) => fixed(v, 2));
  return `${place(tool, k)}<br>EX ${x}, EY ${y}, EZ ${z} µm<br>|E| ${fixed(norm(tool.error_um[k]), 2)} µm`;
}, magnification);

const afterTraces = (tool, magnification) => vectorTraces(tool, tool.example_um, (k) => {
  const [x, y, z] = tool.u_um[k].map((v) => fixed(v, 2));
  return `${place(tool, k)}<br>u(EX) ${x}, u(EY) ${y}, u(EZ) ${z} µm<br>|E| ${fixed(norm(tool.example_um[k]), 2)} µm in this example`;
}, magnification);

function setupTraces(data) {
  const instruments = [...new Set(data.setups.map((setup) => setup.instrument))];
  return instruments.flatMap((instrument) => {
    const own = data.setups.filter((setup) => setup.instrument === instrument);
    return ['path', 'points'].flatMap((form) => {
      const points = own.filter((setup) => setup.form === form).flatMap((setup) => [...setup.point_mm, null]);
      if (points.length === 0) return [];
      const names = own.filter((setup) => setup.form === form).flatMap((setup) => [...setup.point_mm.map(() => plain(setup.name)), '']);
      const shade = series(instrumentIndex(instrument));
      return [{
        x: column(points, 0), y: column(points, 1), z: column(points, 2), text: names, type: 'scatter3d', name: instrument, legendgroup: instrument,
        mode: form === 'path' ? 'lines' : 'markers', line: { color: shade, width: 3 }, marker: { color: transparent(shade, 0.5), size: 1.6 },
        visible: form === 'path' ? true : 'legendonly', hovertemplate: '%{text}<extra></extra>',
      }];
    });
  });
}

function stationTraces(points, inLegend) {
  return [['station', 'diamond', 5], ['centre', 'cross', 3]].flatMap(([kind, symbol, size]) => {
    const own = points.filter((point) => point.kind === kind);
    if (own.length === 0) return [];
    const at = own.map((point) => point.point_mm);
    return [{
      x: column(at, 0), y: column(at, 1), z: column(at, 2), text: own.map((point) => plainInScene(point.name)), customdata: own.map((point) => plain(point.name)), type: 'scatter3d',
      mode: kind === 'station' ? 'markers+text' : 'markers', textposition: 'top center', textfont: { size: 11, color: color('text') },
      marker: { size, symbol, color: color('text') }, name: kind === 'station' ? 'stations' : 'ball-bar centres', showlegend: inLegend,
      hovertemplate: '%{customdata}: %{x:.1f}, %{y:.1f}, %{z:.1f} mm<extra></extra>',
    }];
  });
}

/** Ranges of x, y, z that hold the volume, the stations and the paths: the same in both pictures. */
function ranges(data, tool) {
  const points = [...tool.corner_mm, ...data.named_points.map((point) => point.point_mm),
    ...data.setups.filter((setup) => setup.form === 'path').flatMap((setup) => setup.point_mm)].filter((p) => p !== null);
  return kComponents.map((_, i) => {
    const values = points.map((p) => p[i]);
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const edge = 0.04 * (high - low) + 1;
    return [low - edge, high + edge];
  });
}

function sceneLayout(data, tool, height) {
  const [x, y, z] = ranges(data, tool);
  const axis = (name, range) => ({
    range,
    title: { text: `${name} [mm]`, font: { size: 11, color: color(`axis-${name.toUpperCase()}`) } }, color: color('muted'), gridcolor: color('grid'),
    zeroline: false, showbackground: false, tickfont: { size: 10 }, nticks: 6, showspikes: false,
  });
  return {
    height, margin: { l: 0, r: 0, t: 0, b: 0, autoexpand: false }, paper_bgcolor: 'rgba(0,0,0,0)',
    ...commonLayout(),
    legend: { x: 0, y: 0, yanchor: 'bottom', orientation: 'h', bgcolor: 'rgba(0,0,0,0)', itemsizing: 'constant' }, uirevision: 'keep',
    scene: { domain: { x: [0, 0.87], y: [0.1, 1] }, aspectmode: 'data', xaxis: axis('x', x), yaxis: axis('y', y), zaxis: axis('z', z), camera: kCamera },
  };
}

const kCamera = { eye: { x: 1.52, y: -2.12, z: 1.06 }, center: { x: 0, y: -0.02, z: -0.06 } };

/** Turning one picture turns the other; equal cameras end the exchange. */
function coupleCameras(nodes) {
  nodes.forEach((node, k) => node.on('plotly_relayout', (change) => {
    const camera = change['scene.camera'];
    const other = nodes[1 - k];
    if (!camera || JSON.stringify(camera) === JSON.stringify(other.layout.scene.camera)) return;
    Plotly.relayout(other, { 'scene.camera': structuredClone(camera) });
  }));
}

/** Round magnification at which the largest vector is about a sixth of the volume's diagonal. */
function startMagnification(tool) {
  const [first, last] = [tool.corner_mm[0], tool.corner_mm.at(-1)];
  const wanted = (0.16 * norm(first.map((v, i) => v - last[i]))) / (1e-3 * Math.max(tool.error_max_um, 1e-6));
  const decade = 10 ** Math.floor(Math.log10(wanted));
  return decade * [5, 2, 1].find((step) => step * decade <= wanted);
}

const componentTable = (tool) => table([
  { name: 'Component', align: 'left', cell: (row) => row.component },
  { name: 'Min', unit: 'µm', cell: (row) => fixed(row.min, 1) },
  { name: 'Max', unit: 'µm', cell: (row) => fixed(row.max, 1) },
  { name: 'Range', unit: 'µm', cell: (row) => fixed(row.range, 1) },
  { name: 'u (RMS)', unit: 'µm', cell: (row) => fixed(row.u_rms, 2) },
], tool.components, { caption: `Errors at the places drawn, tool ${tool.name}` });

function slider(view, redraw) {
  const output = el('output', {});
  const input = el('input', { type: 'range', min: '-1', max: '1', step: '0.02', value: '0', 'aria-label': 'Magnification' });
  const show = () => { output.textContent = `${Number(view.magnification.toPrecision(2)).toLocaleString('en-US')} ×`; };
  input.addEventListener('input', () => {
    view.magnification = view.start * 10 ** Number(input.value);
    show();
    redraw();
  });
  show();
  return el('label', { class: 'slider' }, [el('span', { class: 'muted' }, 'Magnification'), input, output]);
}

export function renderVolume(body, data) {
  if (data.tools.length === 0 || data.linear_axes.length < 2) {
    body.append(note('The machine has fewer than two linear axes or no tool: there is no volume to draw.'));
    return;
  }
  const view = { tool: data.tools[0] };
  view.start = view.magnification = startMagnification(view.tool);
  const redraws = [];
  const redraw = () => redraws.forEach((again) => again());
  const tables = el('div', { class: 'volume-table' });
  const captions = [el('figcaption'), el('figcaption')];
  const describe = () => {
    const { tool } = view;
    captions[0].replaceChildren(el('strong', {}, 'Before: '), `identified error, RMS ${fixed(tool.error_rms_um, 1)} µm, max ${fixed(tool.error_max_um, 1)} µm`);
    captions[1].replaceChildren(el('strong', {}, 'After: '), `what correction would leave, RMS ${fixed(tool.u_rms_um, 2)} µm, max ${fixed(tool.u_max_um, 2)} µm (k = 1)`);
    tables.replaceChildren(componentTable(tool));
  };
  const controls = el('div', { class: 'controls' });
  if (data.tools.length > 1) {
    controls.append(choice('Tool', data.tools.map((tool, k) => [k, tool.name]), (k) => {
      view.tool = data.tools[k];
      describe();
      redraw();
    }));
  }
  controls.append(slider(view, redraw));
  const nodes = [el('div', { class: 'plot scene' }), el('div', { class: 'plot scene' })];
  const traces = [beforeTraces, afterTraces];
  const ready = [];
  nodes.forEach((node, k) => redraws.push(addPlot(node, () => ({
    data: [boxTrace(view.tool), ...traces[k](view.tool, view.magnification), ...(k === 0 ? setupTraces(data) : []), ...stationTraces(data.named_points, k === 0)],
    layout: sceneLayout(data, view.tool, sceneHeight(node)),
  }), (drawn) => {
    ready.push(drawn);
    if (ready.length === 2) coupleCameras(nodes);
  })));
  describe();
  body.append(
    controls,
    el('div', { class: 'scenes' }, nodes.map((node, k) => el('figure', {}, [captions[k], node]))),
    el('div', { class: 'volume-foot' }, [tables, el('div', {}, [
    note('Left: identified error of the functional point, each line from the nominal point to the magnified actual one (dot). Right, at the same magnification and with the same shades: one of the error fields that the readings leave possible once the identified errors are corrected, drawn from their joint uncertainty; its direction is not known, its size is that of the uncertainty. It does not cover repeatability, temperature or effects that the model lacks. RMS and the largest error are those of volcal budget: at places all over the volume, from both directions of approach. The best rigid motion is removed from both, as volcal validate does; volumetric_grid.csv has the errors relative to home.'),
    note(`Workpiece coordinates.${data.has_rotary ? ' Rotary axes at 0.' : ''}${data.at_home ? ` ${data.at_home} at home.` : ''} Point at a line to read its setup, click a name in the legend to show or hide what the instrument measured; drag to turn both pictures; the buttons above a picture move and zoom it.`),
    ])]),
  );
}
