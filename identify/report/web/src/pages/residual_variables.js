import { choice, count, el, fixed, note } from '../dom.js';
import { addPlot, jitter, layout2d, legendAbove, plain } from '../plot.js';
import { color, transparent } from '../theme.js';

const kKinds = { length: 'lengths', angle: 'angles', X: 'displacement along X', Y: 'displacement along Y', Z: 'displacement along Z' };

/** Takes a few values only: a name or a direction. */
const isDiscrete = (variable) => variable.categories.length > 0 || variable.name.startsWith('dir_');

/** Excess of the mean square of the means over that of noise, in the standard deviations that noise gives it. */
const excess = (means) => {
  const bins = means?.mean.length ?? 0;
  const squares = (means?.mean ?? []).reduce((sum, value, k) => sum + (value / Math.max(means.noise[k], 1e-12)) ** 2, 0);
  return bins === 0 ? 0 : (squares / bins - 1) * Math.sqrt(bins / 2);
};

/** The section opens on what stands out most; chance alone seldom gives so much, and then it opens on the first. */
const kStandsOut = 4;

class VariableView {
  constructor(data) {
    this.data = data;
    this.model = data.two_models ? 'both' : 'given';
    this.kinds = Object.keys(kKinds).filter((kind) => data.variables.some((variable) => variable[kind]));
    [this.variable, this.kind] = [data.variables[0], this.kinds[0]];
    let strongest = kStandsOut;
    for (const variable of data.variables) {
      for (const kind of this.kinds) {
        const strength = excess(variable[kind]?.given);
        if (strength > strongest) [strongest, this.variable, this.kind] = [strength, variable, kind];
      }
    }
  }

  unit() { return this.kind === 'angle' ? 'µrad' : 'µm'; }

  rows() {
    const wanted = this.kind === 'angle' ? 1 : 0;
    return [...this.data.records.angle.keys()].filter((i) => this.data.records.angle[i] === wanted);
  }

  /** Twice the root mean square of the noise of the drawn readings. */
  band() {
    const { noise } = this.data.records;
    const rows = this.rows();
    return 2 * Math.sqrt(rows.reduce((sum, i) => sum + noise[i] ** 2, 0) / Math.max(1, rows.length));
  }

  hover(i) {
    const { records, setups } = this.data;
    return `<b>${plain(setups[records.setup[i]])}</b>, line ${records.file_line[i]}${records.held_out[i] ? ', held out' : ''}<br>given ${fixed(records.given[i], 2)}, reached ${fixed(records.reached[i], 2)}, noise ${fixed(records.noise[i], 2)} ${this.unit()}`;
  }
}

const shades = { given: () => color('bad'), reached: () => color('good') };
const names = { given: 'given model', reached: 'model reached' };

function points(view, model) {
  const rows = view.rows();
  const spread = isDiscrete(view.variable) ? 0.3 : 0;
  return {
    x: rows.map((i) => view.variable.x[i] + spread * jitter(i)), y: rows.map((i) => view.data.records[model][i]), text: rows.map((i) => view.hover(i)),
    type: 'scatter', mode: 'markers', marker: { size: 3, opacity: 0.35, color: color('data') }, showlegend: false, hovertemplate: '%{text}<extra></extra>',
  };
}

function means(view, model) {
  const mean = view.variable[view.kind]?.[model];
  if (!mean) return [];
  const aside = view.model === 'both' && isDiscrete(view.variable) ? { given: -0.07, reached: 0.07 }[model] : 0;
  return [{
    x: mean.centre.map((x) => x + aside), y: mean.mean, text: mean.count, type: 'scatter', mode: isDiscrete(view.variable) ? 'markers' : 'lines+markers', name: `mean, ${names[model]}`,
    error_y: { type: 'data', array: mean.noise.map((u) => 2 * u), color: shades[model](), thickness: 1.2, width: 0 },
    line: { color: shades[model](), width: 1.8 }, marker: { size: 6, color: shades[model]() }, hovertemplate: `${names[model]}: mean %{y:.3f} ± %{error_y.array:.3f} ${view.unit()} of %{text} readings<extra></extra>`,
  }];
}

function axisX(variable) {
  const title = `${plain(variable.title)}${variable.unit ? ` [${variable.unit}]` : ''}`;
  if (variable.name.startsWith('dir_')) return { title, zeroline: false, showgrid: false, tickvals: [-1, 0, 1], ticktext: ['towards −', 'unknown', 'towards +'], range: [-1.6, 1.6] };
  if (variable.categories.length === 0) return { title, zeroline: false };
  const step = Math.ceil(variable.categories.length / 50);
  const ticks = variable.categories.map((_, k) => k).filter((k) => k % step === 0);
  return {
    title, tickvals: ticks, ticktext: ticks.map((k) => plain(variable.categories[k])), zeroline: false, showgrid: false,
    tickangle: variable.categories.length > 12 ? -60 : 0, range: [-0.6, variable.categories.length - 0.4],
  };
}

const modelsOf = (view) => (view.model === 'both' ? ['given', 'reached'] : [view.model]);

/** Every reading with the band of its noise. */
function readingsPlot(view) {
  const band = view.band();
  const model = view.model === 'both' ? 'reached' : view.model;
  return {
    data: [points(view, model)],
    layout: layout2d({
      height: 340, x: axisX(view.variable), y: { title: `residual, ${names[model]} [${view.unit()}]`, range: [-2.2 * band, 2.2 * band] }, hovermode: 'closest',
      shapes: [{ type: 'rect', xref: 'paper', x0: 0, x1: 1, y0: -band, y1: band, fillcolor: transparent(color('muted'), 0.13), line: { width: 0 }, layer: 'below' }],
    }),
  };
}

/** Means alone, on the scale of what they show. */
function meansPlot(view) {
  const data = modelsOf(view).flatMap((model) => means(view, model));
  return {
    data,
    layout: layout2d({
      height: 340, margin: { t: 30 }, ...legendAbove(),
      x: axisX(view.variable), y: { title: `${view.kind.length === 1 ? `displacement along ${view.kind}` : 'mean residual'} [${view.unit()}]`, rangemode: 'tozero' }, hovermode: 'closest',
    }),
  };
}

export function renderResidualVariables(body, data) {
  if (data.variables.length === 0 || data.drawn === 0) {
    body.append(note('Nothing recorded varies in these readings.'));
    return;
  }
  const view = new VariableView(data);
  const redraws = [];
  const redraw = () => redraws.forEach((again) => again());
  const menu = el('select', { 'aria-label': 'Variable', onchange: (event) => { view.variable = data.variables[Number(event.target.value)]; redraw(); } },
    data.variables.map((variable, k) => el('option', { value: k, selected: variable === view.variable }, variable.title)));
  const controls = el('div', { class: 'controls' }, [el('label', { class: 'menu' }, [el('span', { class: 'muted' }, 'Against'), menu])]);
  if (data.two_models) {
    controls.append(choice('Model', [['both', 'both'], ['given', 'given'], ['reached', 'reached']], (value) => { view.model = value; redraw(); }));
  }
  const order = [view.kind, ...view.kinds.filter((kind) => kind !== view.kind)];
  controls.append(choice('Means of', order.map((kind) => [kind, kKinds[kind]]), (value) => { view.kind = value; redraw(); }));
  body.append(
    note('Reading minus prediction. Left: means in bins, of the readings or of the displacement of the functional point that they ask for (beams from several sides see it with different signs, so that the mean of lengths may hide it), with bars of ± 2 standard deviations that noise alone would give them, its correlated drift and line offsets counted. A mean that leaves zero by more than its bar shows what the model lacks. Right: readings and the band of ± 2 standard deviations of their noise.',
      data.drawn < data.total ? ` ${count(data.drawn)} of ${count(data.total)} readings are drawn, an even choice; means use all.` : ''),
    controls,
  );
  const nodes = [el('div', { class: 'plot' }), el('div', { class: 'plot' })];
  body.append(el('div', { class: 'pair' }, nodes.map((node) => el('figure', {}, node))));
  redraws.push(addPlot(nodes[0], () => meansPlot(view)), addPlot(nodes[1], () => readingsPlot(view)));
}
