import { choice, count, el, fixed, note } from '../dom.js';
import { addPlot, jitter, layout2d, plain } from '../plot.js';
import { color, instrumentIndex, series, transparent } from '../theme.js';

const kJitter = 0.32;

class ResidualView {
  constructor(data) {
    this.data = data;
    this.mode = 'w';
    this.instruments = [...new Set(data.setups.map((setup) => setup.instrument))];
    this.units = [...new Set([...data.records.angle.keys()].map((i) => this.unitOf(i)))];
  }

  unitOf(i) { return this.data.records.angle[i] ? 'µrad' : 'µm'; }

  /** Indices of the drawn readings that the chosen ordinate can show. */
  rows(x) {
    const all = [...this.data.records.w.keys()].filter((i) => x[i] !== null);
    return this.mode === 'w' ? all : all.filter((i) => this.unitOf(i) === this.mode);
  }

  ordinate(i) { return this.mode === 'w' ? this.data.records.w[i] : this.data.records.residual[i]; }

  title() { return this.mode === 'w' ? 'w [–]' : `residual [${this.mode}]`; }

  /** Twice the standard deviation: 2 for w, of the RMS of σ otherwise. */
  band() {
    if (this.mode === 'w') return 2;
    const rows = this.rows(this.data.records.w);
    const mean = rows.reduce((sum, i) => sum + this.data.records.sigma[i] ** 2, 0) / Math.max(1, rows.length);
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
    return `<b>${plain(setup.name)}</b> (${setup.instrument}), line ${records.file_line[i]}<br>residual ${fixed(records.residual[i], 2)} ${this.unitOf(i)}, σ ${fixed(records.sigma[i], 2)} ${this.unitOf(i)}, w ${fixed(records.w[i], 2)}`;
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

/** Mean of w in bins, with the band of ±2 standard deviations that it has when nothing is wrong. */
function meanTraces(view, plot) {
  if (view.mode !== 'w' || plot.mean.centre.length < 2) return [];
  return [{
    x: plot.mean.centre, y: plot.mean.mean, error_y: { type: 'data', array: plot.mean.band, color: color('text'), thickness: 1, width: 0 },
    type: 'scatter', mode: 'lines+markers', line: { color: color('text'), width: 1.6, shape: 'linear' },
    marker: { size: 4, color: color('text') }, hovertemplate: 'mean w %{y:.2f} ± %{error_y.array:.2f}<extra></extra>', name: 'mean',
  }];
}

function againstPlot(view, plot) {
  return {
    data: [...pointTraces(view, plot.x), ...meanTraces(view, plot)],
    layout: layout2d({
      height: 270, x: { title: `${plot.title} [${plot.unit}]`, zeroline: false }, y: { title: view.title(), range: view.range() },
      shapes: bandShapes(view), hovermode: 'closest',
    }),
  };
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
  return {
    data: [...pointTraces(view, x), ...rms],
    layout: layout2d({
      height: 300, x: { title: 'Setup (· station)', tickvals: ticks, ticktext: ticks.map(label), tickangle: setups.length > 12 ? -60 : 0, zeroline: false, showgrid: false, range: [-0.6, setups.length - 0.4] },
      y: { title: view.title(), range: view.range() }, shapes: bandShapes(view), hovermode: 'closest',
    }),
  };
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
    key('line', 'mean without suspects, ± 2 standard deviations; RMS by setup'),
  ]);
}

export function renderResiduals(body, data) {
  const view = new ResidualView(data);
  const redraws = [];
  const controls = el('div', { class: 'controls' });
  controls.append(choice('Ordinate', [['w', 'normalised w'], ...view.units.map((unit) => [unit, `residual in ${unit}`])], (value) => {
    view.mode = value;
    redraws.forEach((redraw) => redraw());
  }), legend(view));
  body.append(note('Reading minus prediction. w is the residual divided by its own standard deviation: with a right model and right noise it is standard normal everywhere. A mean that leaves zero by more than its bar shows an effect that the model lacks.'));
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
  for (const plot of data.plots) {
    const time = plot.axis === 'time';
    add(time ? 'Against time' : el('span', { class: `axis-${plot.axis}` }, `Against ${plot.axis}`), time ? 'wide' : '', () => againstPlot(view, plot));
  }
  const timed = data.plots.some((plot) => plot.axis === 'time');
  const histogram = () => add('Histogram of w and the standard normal curve', '', () => histogramPlot(data.histogram));
  if (timed) histogram();
  add('By setup and station', timed ? 'full' : 'wide', () => setupPlot(view));
  if (!timed) histogram();
  body.append(grid);
}
