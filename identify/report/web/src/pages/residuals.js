import { choice, count, el, fixed, note, significant } from '../dom.js';
import { meansOverReadings } from '../lenses/means_strip.js';
import { addPlot, jitter, layout2d, plain } from '../plot.js';
import { color, instrumentIndex, series, transparent } from '../theme.js';

const kJitter = 0.32;
const kDirectionJitter = 0.24;

/** Ordinates by what residuals are divided by, or their unit; keys as in the data. */
const kUnits = { um: 'µm', urad: 'µrad' };

class ResidualView {
  constructor(data) {
    this.data = data;
    this.isSwallowed = data.swallowed.readings > 0;
    this.mode = this.isSwallowed ? 'stated' : 'w';
    this.instruments = [...new Set(data.setups.map((setup) => setup.instrument))];
    this.units = ['um', 'urad'].filter((unit) => [...data.records.angle.keys()].some((i) => this.unitOf(i) === kUnits[unit]));
  }

  unitOf(i) { return this.data.records.angle[i] ? 'µrad' : 'µm'; }
  isRatio() { return this.mode === 'w' || this.mode === 'stated'; }

  modes() {
    const ratios = this.isSwallowed ? [['stated', 'over the stated σ'], ['w', 'over the estimated noise']] : [['w', 'normalised w']];
    return [...ratios, ...this.units.map((unit) => [unit, `residual in ${kUnits[unit]}`])];
  }

  /** Indices of the drawn readings that the chosen ordinate can show. */
  rows(x) {
    const all = [...this.data.records.w.keys()].filter((i) => x[i] !== null);
    return this.isRatio() ? all : all.filter((i) => this.unitOf(i) === kUnits[this.mode]);
  }

  factor(i) { return this.data.records.factor[i] ?? 1; }

  ordinate(i) {
    if (this.mode === 'w') return this.data.records.w[i];
    return this.mode === 'stated' ? this.data.records.w[i] * this.factor(i) : this.data.records.residual[i];
  }

  title() { return { w: 'w [–]', stated: 'residual / stated σ' }[this.mode] ?? `residual [${kUnits[this.mode]}]`; }
  meanTitle() { return this.isRatio() ? 'mean [–]' : `mean [${kUnits[this.mode]}]`; }

  /** Twice the standard deviation: 2 of ratios, of the RMS of the stated σ otherwise. */
  band() {
    if (this.isRatio()) return 2;
    const rows = this.rows(this.data.records.w);
    const mean = rows.reduce((sum, i) => sum + (this.data.records.sigma[i] / this.factor(i)) ** 2, 0) / Math.max(1, rows.length);
    return 2 * Math.sqrt(mean);
  }

  /** Range that holds every point and the band. */
  range() {
    const { records } = this.data;
    const values = this.rows(records.w).map((i) => Math.abs(this.ordinate(i)));
    const limit = 1.08 * Math.max(2.1 * this.band(), ...values);
    return [-limit, limit];
  }

  hover(i) {
    const { records, setups } = this.data;
    const setup = setups[records.setup[i]];
    const unit = this.unitOf(i);
    const stated = this.isSwallowed ? `, stated σ ${fixed(records.sigma[i] / this.factor(i), 2)} ${unit}` : '';
    return `<b>${plain(setup.name)}</b> (${setup.instrument}), line ${records.file_line[i]}<br>residual ${fixed(records.residual[i], 2)} ${unit}, σ ${fixed(records.sigma[i], 2)} ${unit}${stated}, w ${fixed(records.w[i], 2)}`;
  }
}

function pointTraces(view, x) {
  const { records, setups } = view.data;
  const rows = view.rows(x);
  const trace = (chosen, marker, name) => ({
    x: chosen.map((i) => x[i]), y: chosen.map((i) => view.ordinate(i)), text: chosen.map((i) => view.hover(i)),
    type: 'scatter', mode: 'markers', marker, name, hovertemplate: '%{text}<extra></extra>',
  });
  const traces = view.instruments.map((instrument) =>
    trace(rows.filter((i) => setups[records.setup[i]].instrument === instrument), { size: 3, opacity: 0.55, color: series(instrumentIndex(instrument)) }, instrument));
  const suspect = rows.filter((i) => records.flag[i] > 0);
  traces.push(trace(suspect, { size: 9, symbol: 'circle-open', color: color('bad'), line: { width: 1.6 } }, 'suspect'));
  return traces;
}

function bandShapes(view) {
  const band = view.band();
  const shapes = [{ type: 'rect', xref: 'paper', yref: 'y', x0: 0, x1: 1, y0: -band, y1: band, fillcolor: transparent(color('muted'), 0.13), line: { width: 0 }, layer: 'below' }];
  if (view.mode === 'w' && view.data.critical > 0) {
    for (const y of [-view.data.critical, view.data.critical]) {
      shapes.push({ type: 'line', xref: 'paper', yref: 'y', x0: 0, x1: 1, y0: y, y1: y, line: { color: color('bad'), width: 1, dash: 'dot' } });
    }
  }
  return shapes;
}

const unitOfMode = (view) => (view.isRatio() ? '' : ` ${kUnits[view.mode]}`);

function meansOf(view, plot) {
  const mean = plot.mean[view.mode];
  if (!mean || mean.centre.length === 0) return [];
  return [{
    x: mean.centre, mean: mean.mean, band: mean.band, shade: color('text'), name: 'mean', line: !plot.discrete,
    text: mean.mean.map((value, k) => `mean ${significant(value)} ± ${significant(mean.band[k], 2)}${unitOfMode(view)} of ${count(mean.count[k])} readings`),
  }];
}

const directionAxis = (title) => ({ title, zeroline: false, showgrid: false, tickvals: [-1, 0, 1], ticktext: ['towards −', 'unknown', 'towards +'], range: [-1.5, 1.5] });

function againstPlot(view, plot) {
  const x = plot.discrete ? plot.x.map((value, i) => (value === null ? null : value + kDirectionJitter * jitter(i))) : plot.x;
  return meansOverReadings({
    height: 320, points: pointTraces(view, x), means: meansOf(view, plot), meanTitle: view.meanTitle(), shapes: bandShapes(view),
    x: plot.discrete ? directionAxis(plain(plot.title)) : { title: `${plain(plot.title)} [${plot.unit}]`, zeroline: false }, y: { title: view.title(), range: view.range() },
  });
}

function setupPlot(view) {
  const { records, setups } = view.data;
  const x = records.setup.map((setup, i) => setup + kJitter * jitter(i));
  const order = setups.map((_, k) => k);
  const step = Math.ceil(setups.length / 60);
  const label = (k) => plain(setups[k].station && setups[k].station !== setups[k].name ? `${setups[k].name} · ${setups[k].station}` : setups[k].name);
  const ticks = order.filter((k) => k % step === 0);
  const rms = view.mode !== 'w' ? [] : [{
    x: order, y: setups.map((setup) => setup.rms_w), text: order.map(label), type: 'scatter', mode: 'markers', name: 'RMS of w',
    marker: { symbol: 'line-ew-open', size: 16, color: color('text'), line: { width: 2.2 } }, hovertemplate: '%{text}: RMS of w %{y:.2f}<extra></extra>',
  }];
  const known = order.filter((k) => setups[k].mean[view.mode]);
  const of = (k) => setups[k].mean[view.mode];
  const means = [{
    x: known, mean: known.map((k) => of(k).mean), band: known.map((k) => of(k).band), shade: color('text'), name: 'mean',
    text: known.map((k) => `<b>${label(k)}</b>: mean ${significant(of(k).mean)} ± ${significant(of(k).band, 2)}${unitOfMode(view)}`),
  }];
  return meansOverReadings({
    height: 380, points: [...pointTraces(view, x), ...rms], means, meanTitle: view.meanTitle(), shapes: bandShapes(view),
    x: { title: 'Setup (· station)', tickvals: ticks, ticktext: ticks.map(label), tickangle: setups.length > 12 ? -60 : 0, zeroline: false, showgrid: false, range: [-0.6, setups.length - 0.4] },
    y: { title: view.title(), range: view.range() },
  });
}

function histogramPlot(histogram) {
  const { from, width, count: counts, total } = histogram;
  const centre = counts.map((_, i) => from + (i + 0.5) * width);
  const curve = Array.from({ length: 201 }, (_, i) => from + (i * width * counts.length) / 200);
  const scale = (total * width) / Math.sqrt(2 * Math.PI);
  return {
    data: [
      { x: centre, y: counts, type: 'scatter', mode: 'lines', line: { shape: 'hvh', width: 1, color: color('muted') }, fill: 'tozeroy', fillcolor: transparent(color('muted'), 0.3), hovertemplate: 'w ≈ %{x:.2f}: %{y} readings<extra></extra>' },
      { x: curve, y: curve.map((w) => scale * Math.exp(-0.5 * w * w)), type: 'scatter', mode: 'lines', line: { width: 1.8, color: color('text') }, hoverinfo: 'skip' },
    ],
    layout: layout2d({ height: 270, x: { title: 'w [–], ends hold everything beyond', zeroline: false, dtick: 1 }, y: { title: 'readings' } }),
  };
}

const key = (className, text) => el('span', { class: 'key' }, [el('i', { class: className }), text]);

function legend(view) {
  return el('div', { class: 'legend' }, [
    ...view.instruments.map((name) => key(`dot series-${instrumentIndex(name)}`, name)),
    key('ring', 'suspect (w-test)'),
    key('band', '± 2σ'),
    key('line', 'above each plot, on its own scale: mean without suspects, ± 2 standard deviations'),
  ]);
}

/** Why residuals are divided by the stated noise, where they are. */
function swallowedText(data) {
  const { readings, groups } = data.swallowed;
  const largest = groups.map(({ name, factor }) => `${name} ${significant(factor)} times`).join(', ');
  return `The fit estimated more noise than was stated (${largest}; ${count(readings)} of ${count(data.total)} readings). Noise that large makes every residual look right, an effect that the model lacks among them: these residuals are divided by the stated σ instead, the others by the estimated noise. Suspect readings are those of the estimated noise.`;
}

const headings = (plot) => {
  if (plot.axis.startsWith('dir_')) return el('span', { class: `axis-${plot.axis.at(-1)}` }, `Against the direction of approach of ${plot.axis.at(-1)}`);
  if (plot.axis.startsWith('T_')) return `Against temperature ${plot.axis.slice(2)}`;
  if (plot.axis === 'length') return 'Against the measured length of the beam';
  if (plot.axis === 'time') return 'Against time';
  return el('span', { class: `axis-${plot.axis}` }, `Against ${plot.axis}`);
};

export function renderResiduals(body, data) {
  const view = new ResidualView(data);
  const redraws = [];
  const controls = el('div', { class: 'controls' });
  controls.append(choice('Ordinate', view.modes(), (value) => {
    view.mode = value;
    redraws.forEach((redraw) => redraw());
  }), legend(view));
  body.append(note('Reading minus prediction. w is the residual divided by its own standard deviation: with a right model and right noise it is standard normal everywhere. A mean that leaves zero by more than its bar shows an effect that the model lacks; bars are those of independent readings, or what the scatter between the lines says where that is more.'));
  if (view.isSwallowed) body.append(el('p', { class: 'note strong' }, swallowedText(data)));
  if (data.drawn < data.total) {
    body.append(note(`${count(data.drawn)} of ${count(data.total)} readings are drawn: the suspect and largest ones and an even choice of the others. The histogram counts all, means all but the suspect.`));
  }
  body.append(controls);
  const grid = el('div', { class: 'residuals' });
  const add = (caption, className, make) => {
    const node = el('div', { class: 'plot' });
    grid.append(el('figure', { class: className }, [el('figcaption', {}, caption), node]));
    redraws.push(addPlot(node, make));
  };
  const narrow = data.plots.filter((plot) => plot.axis !== 'time');
  for (const plot of narrow) add(headings(plot), '', () => againstPlot(view, plot));
  add('Histogram of w and the standard normal curve', '', () => histogramPlot(data.histogram));
  for (const plot of data.plots.filter(({ axis }) => axis === 'time')) add(headings(plot), 'full', () => againstPlot(view, plot));
  add('By setup and station', 'full', () => setupPlot(view));
  body.append(grid);
}
