// What the mock program remembers, and how it answers.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { writeFrame } from '../src/api/frames.js';
import { bump, catalogue, kRadius, kSigma, rivalsOf, simulate, truth, unseen } from './mock_campaign.mjs';
import { complete, FormulaError, readFormula } from './mock_formula.mjs';
import { effectNamed, Linear } from './mock_linear.mjs';

const kInstruments = ['laser-tracer', 'ball-bar', 'displacement', 'straightness', 'angle', 'laser-tracker', 'volumetric-points', 'r-test', 'probed-sphere'];
const kVariables = [
  ...['x', 'y', 'z'].map((name) => ({ name, label: name.toUpperCase(), unit: 'mm', kind: 'position', values: null })),
  ...['x', 'y', 'z'].map((name) => ({ name: `dir_${name}`, label: `direction of ${name.toUpperCase()}`, unit: '', kind: 'direction', values: null })),
  { name: 'time', label: 'time', unit: 's', kind: 'time', values: null },
  { name: 'T_air', label: 'air', unit: 'degC', kind: 'temperature', values: null }, { name: 'T_column', label: 'column', unit: 'degC', kind: 'temperature', values: null },
];

const fault = (status, error, remedy = null) => Object.assign(new Error(error), { status, remedy });
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

export class Session {
  constructor({ readings, campaign, tell }) {
    Object.assign(this, { campaign, tell, revision: 0, writer: null, tabs: new Set(), busy: null, tried: 0, inputError: null });
    const { columns, setups } = simulate(readings);
    Object.assign(this, { columns, setups, length: readings, linear: new Linear(columns, readings), formulas: new Map(), looked: new Set() });
    this.y = Float64Array.from({ length: readings }, (_, i) => columns.noise[i] + Object.entries(truth).reduce((sum, [name, a]) => sum + a * effectNamed(name).column(columns, i), 0));
    this.restart();
    this.read();
  }

  restart() {
    this.drawn = {};
    this.models = [];
    this.back = [];
    this.forth = [];
    this.commands = [];
    this.leftOut = [];
    this.add(null, '', [], 'fitted', 'fit');
    this.current = 0;
  }

  read() {
    const former = this.inputError;
    this.inputError = this.campaign ? this.check(readFileSync(this.campaign, 'utf8')) : null;
    if (former || this.inputError) this.changed();
  }

  /** A word for an instrument that there is not. */
  check(text) {
    const lines = text.split('\n');
    const at = lines.findIndex((line) => { const word = line.match(/^instrument\s*=\s*"([^"]*)"/)?.[1]; return word && !kInstruments.includes(word); });
    if (at < 0) return null;
    const from = Math.max(0, at - 4);
    return { file: path.basename(this.campaign), line: at + 1, problem: `no instrument is called ${lines[at].split('"')[1]}`, remedy: `Write one of ${kInstruments.join(', ')}.`, text: lines.slice(from, at + 5).map((line, k) => ({ line: from + k + 1, text: line })) };
  }

  effect(name) { return effectNamed(name) ?? this.formulas.get(name) ?? (() => { throw fault(400, `no effect is called ${name}`); })(); }

  add(parent, change, names, standing, command) {
    const effects = names.map((name) => this.effect(name));
    const fit = this.linear.fit(effects, this.y);
    const model = { number: this.models.length, parent, change, standing, contradiction: null, figures: this.figures(fit.residual), names, effects: effects.map((effect, k) => this.described(effect, { value: fit.amplitude[k], u95: fit.u95[k], mdb: 1.4 * fit.u95[k], gain: 100 })), command };
    this.models.push(model);
    model.residual = fit.residual;
    return model;
  }

  figures(residual) {
    const sums = [0, 0, 0, 0];
    for (let i = 0; i < this.length; i += 1) {
      const k = this.columns.heldout[i] ? 0 : 2;
      sums[k] += residual[i] ** 2;
      sums[k + 1] += 1;
    }
    const [held, fitted] = [sums[0] / sums[1], sums[2] / sums[3]];
    const floor = kSigma * 0.95;
    const systematic = (ms) => Math.sqrt(Math.max(0, ms - floor ** 2));
    const spread = 1.96 * held * Math.sqrt(6 / sums[1]);
    return { systematic_um: systematic(held), systematic_low_um: systematic(held - spread), systematic_high_um: systematic(held + spread), rms_heldout_um: Math.sqrt(held), rms_fit_um: Math.sqrt(fitted), reduced_chi2: fitted / floor ** 2, noise_floor_um: floor };
  }

  described(effect, score) {
    return { name: effect.name, label: effect.label, words: effect.words, amplitudes: [{ label: effect.label, value: score.value, u95: score.u95, detectable: score.mdb, unit: effect.unit }], shape: effect.shape, p: String(10 ** Math.max(-300, -score.gain / 2.3)), log10_p: -score.gain / 2.3, gain: score.gain, visible: 0.9, can_be_added: true, driver: effect.name.split(':')[2] ?? '', causes: '', formula: effect.formula ?? null, surface: Boolean(effect.surface), rivals: rivalsOf[effect.name] ?? [], sketch: effect.sketch };
  }

  now() { return this.models[this.current]; }

  state(tab) {
    return {
      version: '0.9.0', revision: this.revision, read_only: false, writer: true, writer_tab: this.writer ?? '', confirm_behind: false, phase: this.inputError ? 'bad-input' : 'ready', input_error: this.inputError, busy: this.busy, current: this.current,
      campaign: { file: 'campaign.toml', machine: 'VMC 500', structure: 'X Y table, Z column', observations: this.length, setups: this.setups.map((setup, k) => ({ name: setup.name, instrument: setup.instrument, readings: this.columns.setup.filter((s) => s === k).length, channels: [{ name: 'length', unit: setup.unit }], bar: Boolean(setup.bar) })), columns: kVariables },
      notes: ['Set-up pitch_X states no repeatability; 0.5 µrad is assumed.'], models: this.models.map(({ residual, names, ...model }) => model), can_undo: this.back.length > 0, can_redo: this.forth.length > 0, tried: this.tried, left_out: this.leftOut, commands: this.commands, output: '/tmp/volcal-workbench',
    };
  }

  changed() {
    this.revision += 1;
    this.tell('state');
  }

  connected(tab) {
    this.tabs.add(tab);
    this.writer ??= tab;
  }

  left(tab) {
    this.tabs.delete(tab);
    if (this.writer === tab) this.writer = null;
  }

  answer(name, body, tab) {
    if (this.writer === null) this.writer = tab;
    const looks = { state: () => this.state(tab), columns: () => this.sendColumns(body), rank: () => this.rank(), unknown: () => this.unknown(), preview: () => this.preview(this.effect(body.effect)), formula: () => this.formula(body), complete: () => complete(body.text, body.at, kVariables.map((v) => v.name)), periodogram: () => this.periodogram(body), polar: () => this.polar(), rotary: () => ({ rotary: null }), meaning: () => this.meaning(), cancel: () => this.cancel(), take: () => { this.writer = tab; this.changed(); return this.state(tab); } };
    if (looks[name]) return looks[name]();
    if (tab !== this.writer) throw fault(409, 'another tab writes', 'Choose “Write here”.');
    if (this.busy) throw fault(409, 'the program is busy');
    const acts = { add: () => this.step(body), remove: () => this.without(body), go: () => this.goTo(body.model), undo: () => this.wind(this.back, this.forth), redo: () => this.wind(this.forth, this.back), confirm: () => this.confirm(), climb: () => this.climb(), draw: () => this.draw(), 'leave-out': () => this.leave(body), export: () => this.export(body), quit: () => { this.tell('bye', {}); } };
    if (!acts[name]) throw fault(404, `nothing is called ${name}`);
    acts[name]();
    return this.state(tab);
  }

  sendColumns({ names }) {
    const of = (name) => {
      const [what, number] = name.split('@');
      if (what === 'residual') return this.models[Number(number)].residual;
      if (!this.columns[name]) throw fault(400, `no column is called ${name}`);
      return this.columns[name];
    };
    return writeFrame({}, Object.fromEntries(names.map((name) => [name, of(name)])));
  }

  scored(effect) { return this.linear.score(this.now().names.map((name) => this.effect(name)), effect, this.y); }

  rank() {
    const own = this.now().names;
    const list = catalogue.filter((effect) => !effect.hidden && !own.includes(effect.name)).map((effect) => ({ effect, score: this.scored(effect) })).sort((a, b) => b.score.gain - a.score.gain);
    const effects = list.filter(({ score }) => score.gain > 8).map(({ effect, score }, k) => ({ ...this.described(effect, score), fall: k < 12 ? { from_um: this.now().figures.rms_heldout_um, to_um: this.figures(score.residual).rms_heldout_um } : null }));
    return { model: this.current, effects, tried: this.tried, not_visible: unseen, tests: 812 };
  }

  unknown() {
    const own = this.now().names;
    const unknown = own.includes('empirical:y:x:z') || own.some((name) => name.startsWith('formula:')) ? [] : [{ number: 0, label: 'something that depends on x and z along Y', words: 'An effect that is not in the catalogue: it depends on x and z, and acts along Y; its strongest test alone explains 0.42 um RMS of the readings', variables: ['x', 'z'], direction: 'Y', rms_um: 0.42, p: '1e-40', period_mm: null }];
    return { model: this.current, ready: true, unknown_leads: true, unknown, drawn: this.drawn[this.current] ?? [], next: unknown.length === 0 ? [] : ['Measure Y once more from both sides at z = -260 mm: it halves the uncertainty of the surface.'] };
  }

  preview(effect, more = {}, columns = {}) {
    const score = this.scored(effect);
    const column = this.linear.column(effect);
    const rivals = catalogue.filter((each) => each.name !== effect.name && !each.hidden).map((each) => ({ name: each.name, label: each.label, cosine: this.linear.cosine(column, this.linear.column(each)) })).sort((a, b) => Math.abs(b.cosine) - Math.abs(a.cosine)).slice(0, 5);
    return writeFrame({ effect: { ...this.described(effect, score), fall: { from_um: this.now().figures.rms_heldout_um, to_um: this.figures(score.residual).rms_heldout_um } }, rivals, ...more }, { residual: score.residual, ...columns });
  }

  formula({ text }) {
    const { axis, column } = readFormula(text, kVariables.map((v) => v.name));
    const name = `formula:${text}`;
    const effect = { name, label: text, unit: 'um', words: 'A formula of your own.', shape: '', formula: text, column, sketch: [] };
    if (this.linear.dot(this.linear.column(effect), this.linear.column(effect)) < 1e-12) throw new FormulaError('the readings feel nothing of it', `Along ${axis.toUpperCase()} it is zero everywhere.`, 1);
    this.formulas.set(name, effect);
    this.looked.add(text);
    this.tried = this.looked.size;
    return this.preview(effect, { tried: this.tried }, { driver: Float32Array.from(this.linear.column(effect)) });
  }

  periodogram({ variable }) {
    const period = Array.from({ length: 300 }, (_, k) => 10 ** (0.3 + (2 * k) / 299));
    const own = this.now().names.includes('cyclic:EXX:x:10mm:sin');
    const power = period.map((p, k) => 3 + 2 * Math.sin(k * 1.7) + (variable === 'x' && !own ? 60 * Math.exp(-(((p - 10.02) / 0.35) ** 2)) : 0));
    return { variable, period, power, level: 14.2, peak: period[power.indexOf(Math.max(...power))] };
  }

  polar() {
    const circles = this.setups.flatMap((setup, s) => (setup.bar ? [{ setup, s }] : [])).map(({ setup, s }) => {
      const rows = [...this.columns.setup.keys()].filter((i) => this.columns.setup[i] === s);
      const residual = this.now().residual;
      return { name: setup.name, setup: s, rows: rows.map((i) => this.columns.row[i]), plane: setup.plane.map((k) => 'XYZ'[k]).join(''), radius_mm: kRadius, angle_deg: rows.map((i) => this.columns.angle[i]), sense: rows.map((i) => this.columns.sense[i]), measured_um: rows.map((i) => this.y[i] + 2 * Math.cos((2 * this.columns.angle[i] * Math.PI) / 180)), predicted_um: rows.map((i) => this.y[i] - residual[i] + 2 * Math.cos((2 * this.columns.angle[i] * Math.PI) / 180)) };
    });
    return { circles };
  }

  meaning() {
    const { systematic_um: left } = this.now().figures;
    return { rms_um: 14.2, share: [['squareness', 9.1, 41], ['positioning', 7.2, 26], ['angles', 6, 18], ['straightness', 3.3, 8], ...this.now().effects.map((effect) => [effect.label, 1.2, 3])].map(([label, um, percent]) => ({ label, um, u95_um: 0.1 * um, percent })), tool: 'short', not_in_volume: [], left: { before_um: 14.2, by_uncertainty_um: left, by_time_and_temperature_um: 0.8, held_by_no_table: ['thermal EXX'] }, detectable: catalogue.filter((effect) => !effect.hidden).map((effect) => ({ kind: effect.name, label: effect.label, detectable: this.scored(effect).mdb, unit: effect.unit })) };
  }

  moved(number) {
    this.back.push(this.current);
    this.forth = [];
    this.current = number;
  }

  step({ effect }) {
    const text = effect.startsWith('formula:') ? effect : null;
    const chosen = text && !this.formulas.has(effect) ? this.formulas.get([...this.formulas.keys()].at(-1)) : this.effect(effect);
    this.tried += 1;
    const model = this.add(this.current, chosen.label, [...this.now().names, chosen.name], 'preview', `add ${chosen.name}`);
    this.moved(model.number);
    this.commands.push(model.command);
    this.changed();
  }

  without({ effect }) {
    const model = this.add(this.current, `− ${this.effect(effect).label}`, this.now().names.filter((name) => name !== effect), 'preview', `remove ${effect}`);
    this.moved(model.number);
    this.commands.push(model.command);
    this.changed();
  }

  goTo(model) {
    if (!this.models[model]) throw fault(400, 'no such model');
    this.moved(model);
    this.changed();
  }

  wind(from, to) {
    if (from.length === 0) throw fault(400, 'nothing to undo');
    to.push(this.current);
    this.current = from.pop();
    this.changed();
  }

  /** Work that takes long: stages with progress, then `end`, unless it is cancelled. */
  async long(what, stages, end) {
    const ticket = {};
    this.ticket = ticket;
    for (let k = 0; k < 10; k += 1) {
      this.busy = { what, model: this.current, stage: stages[Math.floor((k * stages.length) / 10)], share: k / 10, left_s: (10 - k) * 0.12 };
      if (k === 0) this.changed();
      this.tell('progress', this.busy);
      await wait(120);
      if (this.ticket !== ticket) return;
    }
    this.busy = null;
    end();
    this.changed();
  }

  cancel() {
    this.ticket = null;
    this.busy = null;
    this.changed();
    return this.state(this.writer);
  }

  confirm() {
    this.long('confirm', ['adjustment', 'noise', 'smoothing'], () => { this.now().standing = 'fitted'; this.commands.push('confirm'); });
  }

  climb() {
    this.long('climb', ['ranking', 'adding'], () => {
      for (let best = this.rank().effects[0]; best; best = this.rank().effects[0]) {
        const model = this.add(this.current, best.label, [...this.now().names, best.name], 'fitted', `add ${best.name}`);
        this.moved(model.number);
      }
      this.commands.push('climb');
    });
  }

  draw() {
    this.long('draw', ['smoothing', 'picture'], () => {
      const [xs, zs] = [Array.from({ length: 24 }, (_, k) => -250 + (500 * k) / 23), Array.from({ length: 20 }, (_, k) => -400 + (400 * k) / 19)];
      const value = xs.flatMap((x) => zs.map((z) => bump(x, z)));
      this.formulas.set('formula:law', { name: 'formula:law', label: 'EYY += exp(-((x - 90)/80)^2 - ((z + 260)/90)^2)', unit: 'um', words: '', shape: '', column: effectNamed('empirical:y:x:z').column, sketch: [] });
      const surface = { label: 'something that depends on x and z along Y', drivers: ['x', 'z'], unit: 'um', places: [xs, zs], value, u95: value.map(() => 0.2), dots: [xs.flatMap((x) => [x, x]), zs.concat(zs).concat(zs.slice(0, 8))], free: ['a constant'], name: 'empirical:y:x:z', formulas: [{ text: 'EYY += exp(-((x - 90)/80)^2 - ((z + 260)/90)^2)', name: 'formula:law', amplitude: 2.21, u95: 0.1, unit: 'um', log_evidence: 812 }] };
      this.drawn[this.current] = [surface];
      this.tell('surface', surface);
    });
  }

  leave({ observations, reason }) {
    this.long('leave-out', ['adjustment'], () => {
      for (const i of observations) this.columns.left_out[i] = 1;
      this.leftOut.push({ readings: observations.length, reason });
      const model = this.add(this.current, `without ${observations.length} readings`, this.now().names, 'fitted', `leave-out ${observations.length} "${reason}"`);
      this.moved(model.number);
      this.commands.push(model.command);
    });
  }

  export({ what }) {
    this.long('export', ['writing'], () => this.tell('exported', { what, files: [`/tmp/volcal-workbench/${what}.toml`] }));
  }
}
