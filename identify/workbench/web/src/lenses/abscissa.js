// The variable below a picture: its values, range, bins and ticks.
import { jitter } from '../../../../report/web/src/plot.js';
import { binIndex, rangeOf } from '../data/statistics.js';
import { stepsOf, titleOf } from '../data/variables.js';
import { padded } from '../draw/scale.js';

const made = new WeakMap();

function jitters(length, width) {
  const out = new Float32Array(length);
  for (let i = 0; i < length; i += 1) out[i] = width * jitter(i);
  return out;
}

function make(variable, values) {
  const steps = stepsOf(variable, values);
  if (steps) {
    const gap = steps.at.length > 1 ? Math.min(...steps.at.slice(1).map((value, k) => value - steps.at[k])) : 1;
    const [low, high] = [steps.at[0] - 0.6 * gap, steps.at.at(-1) + 0.6 * gap];
    const index = new Int16Array(values.length).fill(-1);
    const place = new Map(steps.at.map((value, k) => [Math.fround(value), k]));
    for (let i = 0; i < values.length; i += 1) index[i] = place.get(values[i]) ?? -1;
    return { steps, low, high, bins: steps.at.length, index, centres: steps.at, shift: jitters(values.length, 0.28 * gap), gap };
  }
  const range = rangeOf(values) ?? [0, 1];
  const [low, high] = padded(range, 0.02);
  const bins = values.length > 3000 ? 48 : 24;
  const width = (range[1] - range[0]) / bins;
  return {
    steps: null, low, high, bins, index: binIndex(values, range[0], range[1], bins), shift: null, gap: width,
    centres: Array.from({ length: bins }, (_, k) => range[0] + (k + 0.5) * width),
  };
}

/** Kept with the column, so that only a new variable costs anything. */
export function abscissa(view, name) {
  const variable = view.variables.find((each) => each.name === name);
  const values = view.column(name);
  if (!variable || !values) return null;
  if (!made.has(values)) made.set(values, make(variable, values));
  return { ...made.get(values), variable, values, title: titleOf(variable) };
}
