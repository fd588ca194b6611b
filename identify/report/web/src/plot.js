// Plots: drawn when they come near the screen (and all of them for printing), redrawn when colours change.
import { color } from './theme.js';

const plots = [];
const config = { responsive: true, displaylogo: false, displayModeBar: true,
  modeBarButtonsToRemove: ['select2d', 'lasso2d', 'autoScale2d', 'resetCameraLastSave3d'] };

const near = new IntersectionObserver((entries) => {
  for (const entry of entries) if (entry.isIntersecting) draw(plots.find((plot) => plot.node === entry.target));
}, { rootMargin: '600px' });

function draw(plot) {
  if (plot.drawn) return;
  plot.drawn = true;
  near.unobserve(plot.node);
  const { data, layout } = plot.make();
  Plotly.newPlot(plot.node, data, layout, config).then(() => plot.onDrawn?.(plot.node));
}

/** Registers a plot in `node`; `make` returns { data, layout }. Returns a function that draws it again. */
export function addPlot(node, make, onDrawn) {
  const plot = { node, make, onDrawn, drawn: false };
  plots.push(plot);
  near.observe(node);
  return () => update(plot);
}

function update(plot) {
  if (!plot.drawn) return;
  const { data, layout } = plot.make();
  Plotly.react(plot.node, data, layout, config);
}

/** Draws every plot and fits it to the present width of its place. */
export function drawAll() {
  for (const plot of plots) {
    if (plot.drawn) Plotly.Plots.resize(plot.node);
    else draw(plot);
  }
}
export const redrawAll = () => plots.forEach(update);

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
