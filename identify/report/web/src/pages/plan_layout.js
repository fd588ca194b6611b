import { choice, count, el, fixed, note, significant, table } from '../dom.js';
import { addPlot, column, commonLayout, layout2d, legendAbove, plain, plainInScene, sceneHeight, segments } from '../plot.js';
import { color, series } from '../theme.js';

const edges = (corners) => corners.flatMap((corner, a) =>
  [1, 2, 4].filter((bit) => !(a & bit)).map((bit) => [corner, corners[a | bit]]));

const boxTrace = (corners, name, shade, dash) => ({
  ...segments(edges(corners)), type: 'scatter3d', mode: 'lines', line: { color: shade, width: dash ? 1 : 2, dash: dash ?? 'solid' }, hoverinfo: 'skip', name,
});

const stationsOf = (campaign) => {
  const seen = new Map();
  for (const setup of campaign.setups) if (setup.station_mm !== null && !seen.has(setup.station)) seen.set(setup.station, setup.station_mm);
  return [...seen];
};

/** Positions in one shade a tool, some beams of each setup in the same. */
function toolTraces(campaign, tools) {
  return tools.flatMap((tool, k) => {
    const own = campaign.setups.filter((setup) => setup.tool === tool);
    if (own.length === 0) return [];
    const points = own.flatMap((setup) => setup.point_mm);
    const names = own.flatMap((setup) => setup.point_mm.map(() => plain(setup.name)));
    const beams = own.filter((setup) => setup.station_mm !== null).flatMap((setup) => setup.beam_mm.map((point) => [setup.station_mm, point]));
    return [
      { ...segments(beams), type: 'scatter3d', mode: 'lines', opacity: 0.3, line: { color: series(k), width: 1.5 }, hoverinfo: 'skip', showlegend: false, legendgroup: tool },
      {
        x: column(points, 0), y: column(points, 1), z: column(points, 2), text: names, type: 'scatter3d', mode: 'markers', name: `tool ${plain(tool)}`, legendgroup: tool,
        marker: { color: series(k), size: 2.2 }, hovertemplate: '%{text}<br>%{x:.0f}, %{y:.0f}, %{z:.0f} mm<extra></extra>',
      },
    ];
  });
}

function stationTrace(data, campaign) {
  const stations = stationsOf(campaign);
  const at = stations.map(([, place]) => place);
  return {
    x: column(at, 0), y: column(at, 1), z: column(at, 2), text: stations.map(([name]) => plainInScene(name)), customdata: stations.map(([name]) => plain(name)),
    type: 'scatter3d', mode: 'markers+text', textposition: 'top center', textfont: { size: 13, color: color('text') },
    marker: { size: 6, symbol: 'diamond', color: color('text') }, name: data.places, hovertemplate: '%{customdata}: %{x:.0f}, %{y:.0f}, %{z:.0f} mm<extra></extra>',
  };
}

function picture(data, campaign, node) {
  const tools = [...new Set(data.campaigns.flatMap((each) => each.setups.map((setup) => setup.tool)))];
  const axis = (name) => ({
    title: { text: `${name} [mm]`, font: { size: 11, color: color(`axis-${name.toUpperCase()}`) } }, color: color('muted'), gridcolor: color('grid'),
    zeroline: false, showbackground: false, tickfont: { size: 10 }, nticks: 6, showspikes: false,
  });
  return {
    data: [boxTrace(data.volume_mm, 'functional points', color('muted')), boxTrace(data.region_mm, data.region, color('rule'), 'dash'),
      ...toolTraces(campaign, tools), stationTrace(data, campaign)],
    layout: {
      height: Math.round(1.15 * sceneHeight(node)), margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: 'rgba(0,0,0,0)', ...commonLayout(), uirevision: 'keep',
      legend: { x: 0, y: 0, yanchor: 'bottom', orientation: 'h', bgcolor: 'rgba(0,0,0,0)', itemsizing: 'constant' },
      scene: { domain: { x: [0, 1], y: [0.08, 1] }, aspectmode: 'data', xaxis: axis('x'), yaxis: axis('y'), zaxis: axis('z'), camera: { eye: { x: 0.95, y: -1.32, z: 0.62 }, center: { x: 0, y: 0, z: -0.05 } } },
    },
  };
}

const turns = (data) => data.rotary_axes.length > 0 && data.campaigns.some((campaign) => campaign.setups.some((setup) => setup.rotary_deg.length > 0));

/** Positions of the rotary axes, the first over the second, one shade a tool. */
function rotaryPicture(data, campaign) {
  const tools = [...new Set(data.campaigns.flatMap((each) => each.setups.map((setup) => setup.tool)))];
  const [first, second] = data.rotary_axes;
  const traces = tools.map((tool, k) => {
    const own = campaign.setups.filter((setup) => setup.tool === tool);
    const at = own.flatMap((setup) => setup.rotary_deg);
    return {
      x: column(at, 0), y: second === undefined ? at.map(() => 0) : column(at, 1), text: own.flatMap((setup) => setup.rotary_deg.map(() => plain(setup.name))), type: 'scatter', mode: 'markers', name: `tool ${plain(tool)}`,
      marker: { size: 6, symbol: ['circle', 'square', 'triangle-up', 'diamond'][k % 4], color: series(k) }, hovertemplate: `%{text}<br>${first} %{x:.1f}°${second === undefined ? '' : `, ${second} %{y:.1f}°`}<extra></extra>`,
    };
  });
  return { paperHeight: 0.7, data: traces, layout: layout2d({ height: 360, margin: { t: 40 }, ...legendAbove(), hovermode: 'closest', x: { title: `${first} [°]` }, y: { title: second === undefined ? '' : `${second} [°]` } }) };
}

const capital = (word) => word.charAt(0).toUpperCase() + word.slice(1);

function stationTable(data, campaign) {
  const rows = stationsOf(campaign).map(([name, place]) => ({
    name, place,
    runs: campaign.setups.filter((setup) => setup.station === name).map((setup) => [setup.tool, setup.part, setup.readings].filter((word) => word !== '').join(' ')).join(', '),
    off: campaign.may_be_off_mm[name],
  }));
  return table([
    { name: capital(data.place), align: 'left', cell: (row) => row.name },
    ...['x', 'y', 'z'].map((name, i) => ({ name, unit: 'mm', cell: (row) => fixed(row.place[i], 0) })),
    { name: 'May be off', unit: 'mm', title: 'along any axis, until the target is 1 % worse', cell: (row) => (row.off === 0 ? '< 10' : fixed(row.off, 0)) },
    { name: 'Readings by tool', align: 'left', cell: (row) => row.runs },
  ], rows, { caption: data.heading });
}

const figures = (campaigns) => table([
  { name: 'Campaign', align: 'left', cell: (row) => row.name },
  { name: 'Setups', cell: (row) => count(row.setups.length) },
  { name: 'Readings', cell: (row) => count(row.readings) },
  { name: 'Time', unit: 'h', cell: (row) => fixed(row.time_h, 2) },
  { name: 'u in the volume', unit: 'µm RMS', cell: (row) => significant(row.u_rms_um, 3) },
  { name: 'Largest', unit: 'µm', cell: (row) => significant(row.u_largest_um, 3) },
  { name: 'Worst length', unit: 'µm', cell: (row) => significant(row.worst_length_um, 2) },
  { name: '', align: 'left', cell: (row) => row.worst_length_at },
  { name: 'Worst angle', unit: 'µrad', cell: (row) => significant(row.worst_angle_urad, 2) },
  { name: '', align: 'left', cell: (row) => row.worst_angle_at },
  { name: 'Not visible', align: 'left', cell: (row) => (row.not_visible.length === 0 ? '–' : row.not_visible.join(', ')) },
], campaigns);

const optionTable = (options) => table([
  { name: 'One setup more', align: 'left', cell: (row) => row.words },
  { name: 'Readings', cell: (row) => count(row.readings) },
  { name: 'u in the volume', unit: 'µm RMS', cell: (row) => significant(row.u_um, 3) },
  { name: 'Makes visible', align: 'left', cell: (row) => row.made_visible.join(', ') || '–' },
  { name: 'Still not visible', align: 'left', cell: (row) => row.still_invisible.join(', ') || '–' },
], options);

export function renderPlanLayout(body, data) {
  const view = { campaign: data.campaigns[0] };
  const change = 100 * Math.abs(1 - data.ratio);
  body.append(el('p', {}, data.replaced
    ? data.replaced
    : [el('strong', {}, `${fixed(change, 1)} % ${data.ratio <= 1 ? 'less' : 'more'}`), ` than ${data.against}: ${data.target}.`]));
  const messages = [...data.invisible, ...data.messages];
  if (messages.length > 0) body.append(el('ul', { class: 'messages' }, messages.map((text) => el('li', {}, text))));
  body.append(figures(data.campaigns));
  if (data.values_a_reading > 1) body.append(note(`A reading is ${data.values_a_reading} values, which campaigns count one by one.`));
  const node = el('div', { class: 'plot scene' });
  const stations = el('div', {});
  const redraws = [addPlot(node, () => picture(data, view.campaign, node))];
  const describe = () => stations.replaceChildren(stationTable(data, view.campaign));
  const options = data.campaigns.map((campaign, k) => [k, campaign.name]);
  const controls = choice('Show', options, (k) => {
    view.campaign = data.campaigns[k];
    describe();
    redraws.forEach((again) => again());
  });
  describe();
  body.append(
    el('div', { class: 'controls' }, controls), node, el('h3', {}, data.heading), stations,
    note(`Workpiece coordinates. Dots: functional points where readings are taken, every one from both directions; lines: some of the beams or bars. Click a name in the legend to show or hide it; drag to turn; the buttons above the picture move and zoom it. ${data.checked}`),
  );
  if (turns(data)) {
    const rotary = el('div', { class: 'plot' });
    redraws.push(addPlot(rotary, () => rotaryPicture(data, view.campaign)));
    body.append(el('h3', {}, 'Positions of the rotary axes'), rotary, note('The linear axes follow, so that the tool stays on its sphere; every position is met from both directions.'));
  }
  if (data.options.length > 0) body.append(el('h3', {}, 'What one setup more would bring'), optionTable(data.options));
}
