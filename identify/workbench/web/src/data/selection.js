// What is marked: one byte for every reading, and what can be said of it.
import { standardisedDifference } from './statistics.js';

export const emptySelection = { mask: null, count: 0 };

/** Readings for which `inside(i)` holds, among those that are shown; added to what is marked, or in place of it. */
export function mark(length, shown, inside, former = null) {
  const mask = former ? Uint8Array.from(former) : new Uint8Array(length);
  let count = 0;
  for (let i = 0; i < length; i += 1) {
    if ((!shown || shown[i]) && inside(i)) mask[i] = 1;
    count += mask[i];
  }
  return count > 0 ? { mask, count } : emptySelection;
}

/** Numbers of the marked readings. */
export function indices(mask) {
  const list = [];
  for (let i = 0; i < mask.length; i += 1) if (mask[i]) list.push(i);
  return list;
}

/** Mean of the marked readings and its standard deviation, readings of a line counted together. */
export function meanOf(values, mask, lines) {
  let n = 0;
  let sum = 0;
  for (let i = 0; i < values.length; i += 1) {
    if (!mask[i] || values[i] !== values[i]) continue;
    n += 1;
    sum += values[i];
  }
  if (n === 0) return { mean: NaN, u: NaN };
  const mean = sum / n;
  const sums = new Float64Array(lines ? lines.count : 0);
  const touched = new Uint8Array(sums.length);
  let scatter = 0;
  for (let i = 0; i < values.length; i += 1) {
    if (!mask[i] || values[i] !== values[i]) continue;
    const off = values[i] - mean;
    scatter += off * off;
    if (lines) {
      sums[lines.index[i]] += off;
      touched[lines.index[i]] = 1;
    }
  }
  const groups = touched.reduce((count, one) => count + one, 0);
  const clustered = groups >= 3 ? (sums.reduce((all, off) => all + off * off, 0) * groups) / (groups - 1) : 0;
  return { mean, u: Math.sqrt(Math.max(clustered, scatter)) / n };
}

/** The one value that all marked readings share in a column, or null. */
export function sharedValue(values, mask) {
  let shared = null;
  for (let i = 0; i < values.length; i += 1) {
    if (!mask[i]) continue;
    if (values[i] !== values[i] || (shared !== null && values[i] !== shared)) return null;
    shared = values[i];
  }
  return shared;
}

/** Variables in which the marked readings differ from the rest, the most telling first. */
export function standOut(variables, columns, mask, shown) {
  return variables
    .map((variable) => ({ variable, difference: columns[variable.name] ? standardisedDifference(columns[variable.name], mask, shown) : 0 }))
    .filter(({ difference }) => difference > 0.3)
    .sort((a, b) => b.difference - a.difference);
}
