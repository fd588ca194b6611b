// Columns of the readings: asked for once, kept as they are sent.
import { signal } from '@preact/signals';
import { call } from '../api/call.js';
import { numberLines } from '../data/statistics.js';
import { modelOf, state } from './store.js';

const kept = new Map(); // by name: { key, values }
const asked = new Map();
/** Grows whenever a column has come. */
export const arrived = signal(0);

/** Residuals belong to a model as it stands: a full fit makes others. */
function stamp(name) {
  const [, number] = name.split('@');
  if (number === undefined) return name;
  const model = modelOf(Number(number));
  return `${name} ${model?.standing} ${JSON.stringify(model?.figures)}`;
}

/** The column, of a model as it stood before until the new one is there; null: it was never there. */
export const column = (name) => kept.get(name)?.values ?? null;
const isKept = (name) => kept.get(name)?.key === stamp(name);

/** A column that is here already under another name. */
export function keep(name, values) {
  kept.set(name, { key: stamp(name), values });
  arrived.value += 1;
}

let batch = null;

function flush() {
  const names = batch.names;
  const { resolve, reject } = batch;
  const stamps = names.map(stamp);
  batch = null;
  call('columns', { names }).then(({ columns }) => {
    const isWanted = (name, k) => columns[name] && (stamps[k] === stamp(name) || !kept.has(name));
    names.forEach((name, k) => { if (isWanted(name, k)) kept.set(name, { key: stamps[k], values: columns[name] }); });
    arrived.value += 1;
    resolve();
  }).catch(reject).finally(() => stamps.forEach((key) => asked.delete(key)));
}

/** Asks for what is not there yet; all that is asked for at once goes in one request. */
export function ensure(names) {
  const waits = [];
  for (const name of names.filter(Boolean)) {
    if (isKept(name)) continue;
    const key = stamp(name);
    if (!asked.has(key)) {
      if (!batch) {
        batch = { names: [] };
        batch.done = new Promise((resolve, reject) => Object.assign(batch, { resolve, reject }));
        queueMicrotask(flush);
      }
      batch.names.push(name);
      asked.set(key, batch.done);
    }
    waits.push(asked.get(key));
  }
  return Promise.all(waits);
}

export function clearColumns() {
  kept.clear();
  asked.clear();
  lines = null;
  arrived.value += 1;
}

let lines = null;

/** Lines of all set-ups, numbered. */
export function linesOfReadings() {
  const [setup, line] = [column('setup'), column('line')];
  if (!setup || !line) return null;
  if (lines?.of !== line) lines = Object.assign(numberLines(setup, line), { of: line });
  return lines;
}

export const kFirst = ['setup', 'channel', 'line', 'row', 'stated_sigma', 'heldout', 'left_out', 'point_x', 'point_y', 'point_z', 'along_x', 'along_y', 'along_z'];

/** What every picture needs of the current model and the one before. */
export const residualNames = (...models) => models.filter(Boolean).map((model) => `residual@${model.number}`);
export const observations = () => state.value?.campaign?.observations ?? 0;
