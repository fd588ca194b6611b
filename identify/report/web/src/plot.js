// Plots: drawn when they come near the screen (and all of them for printing), redrawn when colours change.
import { color } from './theme.js';

const plots = [];
/** The wheel scrolls the page, also over a picture in space; nothing is sent anywhere. */
const config = { responsive: true, displaylogo: false, displayModeBar: true, scrollZoom: false,
  showSendToCloud: false, showEditInChartStudio: false, plotlyServerURL: '',
  modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d', 'resetCameraLastSave3d'] };

const kPaperHeight = 0.62; // of the height on the screen
let onPaper = false;

const near = new IntersectionObserver((entries) => {
  for (const entry of entries) if (entry.isIntersecting) draw(plots.find((plot) => plot.node === entry.target));
}, { rootMargin: '600px' });

/** What is drawn: on paper lower, and as wide as its place without waiting for a resize. */
function figureOf(plot) {
  const { data, layout, paperHeight = kPaperHeight } = plot.make();
  if (onPaper) Object.assign(layout, { height: Math.round(paperHeight * layout.height), width: plot.node.clientWidth });
  return { data, layout };
}

function draw(plot) {
  if (plot.drawn) return;
  plot.drawn = true;
  near.unobserve(plot.node);
  const { data, layout } = figureOf(plot);
  Plotly.newPlot(plot.node, data, layout, config).then(() => plot.onDrawn?.(plot.node));
}

/** Registers a plot in `node`; `make` returns { data, layout } and, where its lines of text ask for it, paperHeight. Returns a function that draws it again. */
export function addPlot(node, make, onDrawn) {
  const plot = { node, make, onDrawn, drawn: false };
  plots.push(plot);
  // A scene takes the wheel for itself, even where it does not zoom by it.
  node.addEventListener('wheel', (event) => event.stopPropagation(), { capture: true, passive: true });
  near.observe(node);
  return () => update(plot);
}

/** Forgets the plots of a part of the page that is shown no more. */
export function dropPlots(part) {
  const nodes = new Set(part.querySelectorAll('.plot'));
  for (const plot of plots.filter(({ node }) => nodes.has(node))) {
    near.unobserve(plot.node);
    if (plot.drawn) Plotly.purge(plot.node);
    plots.splice(plots.indexOf(plot), 1);
  }
}

function update(plot) {
  if (!plot.drawn) return;
  const { data, layout } = figureOf(plot);
  Plotly.react(plot.node, data, layout, config);
}

/** Draws every plot for paper, or for the screen again. */
export function drawForPaper(paper) {
  onPaper = paper;
  for (const plot of plots) {
    plot.node.style.minHeight = paper ? '0' : '';
    if (plot.drawn) update(plot);
    else draw(plot);
  }
}
export const redrawAll = () => plots.forEach(update);

/** On a touch screen a picture in space turns only after a tap on it: before that, fingers scroll the page. */
export function wakeScenes(main) {
  addEventListener('click', ({ target }) => {
    for (const scene of main.querySelectorAll('.scene')) scene.classList.toggle('awake', scene === target.closest?.('.scene'));
  });
}

const axisLine = () => ({
  color: color('muted'),
  gridcolor: color('grid'),
  linecolor: color('rule'),
  zerolinecolor: color('zero'),
  zerolinewidth: 1,
  ticks: 'outside',
  ticklen: 4,
  tickcolor: color('rule'),
  showline: true,
  automargin: true,
});

/** Fonts and colours of every plot. */
export const commonLayout = () => ({
  font: { family: 'system-ui, sans-serif', size: 11, color: color('text') },
  hoverlabel: { bgcolor: color('page'), bordercolor: color('rule'), font: { color: color('text'), size: 12 } },
  modebar: { bgcolor: color('page'), color: color('muted'), activecolor: color('text') },
});

/** Height of a picture in space: a scene is drawn to the height, so that a narrow one must be low to show its edges. */
export const sceneHeight = (node) => Math.round(Math.min(520, Math.max(320, 0.92 * node.clientWidth)));

/** Text that is not the report's own (names of setups, stations, tools): the plot library would read markup in it. */
export const plain = (text) => String(text).replaceAll('&', '&amp;').replaceAll('<', '&lt;');

/** The same for names beside the points of a scene, where entities are not read: a gap of no width ends every tag. */
export const plainInScene = (text) => String(text).replaceAll('<', '<\u200b');

/** Even pseudo-random number in -1..1 from an index, the same on every drawing. */
export const jitter = (i) => (((i * 2654435761) >>> 0) / 2 ** 31) - 1;

export const norm = (v) => Math.hypot(...v);

/** One coordinate of points; a missing point is a gap. */
export const column = (points, i) => points.map((point) => (point === null ? null : point[i]));

/** Separate segments as one polyline with gaps. */
export function segments(pairs) {
  const ends = pairs.flatMap(([from, to]) => [from, to, null]);
  return { x: column(ends, 0), y: column(ends, 1), z: column(ends, 2) };
}

/** Light to strong shades for sizes up to `largest`. */
export const sizeShades = (largest) => ({ colorscale: [0, 1, 2, 3].map((k) => [k / 3, color(`size-${k}`)]), cmin: 0, cmax: largest });

export const colorBar = (title, x) => ({
  title: { text: title, side: 'right', font: { size: 11 } }, thickness: 10, len: 0.6, x, outlinewidth: 0, tickfont: { size: 10, color: color('text') },
});

/** Layout of a plot with its legend in one line above. */
export const legendAbove = () => ({ showlegend: true, legend: { orientation: 'h', y: 1.01, yanchor: 'bottom', x: 0, font: { size: 11 } } });

/** Layout of a two-dimensional plot with titled axes. */
export function layout2d({ x, y, height, margin = {}, ...rest }) {
  return {
    height,
    margin: { l: 48, r: 10, t: 8, b: 40, ...margin },
    paper_bgcolor: 'rgba(0,0,0,0)',
    plot_bgcolor: 'rgba(0,0,0,0)',
    ...commonLayout(),
    showlegend: false,
    xaxis: { ...axisLine(), ...x, title: { text: x.title, standoff: 6, font: { size: 11 } } },
    yaxis: { ...axisLine(), ...y, title: { text: y.title, standoff: 6, font: { size: 11 } } },
    ...rest,
  };
}
