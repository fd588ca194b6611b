// Means, histograms and contrasts of columns: plain loops over typed arrays.

/** Smallest and largest finite value; null where there is none. */
export function rangeOf(values, mask = null) {
  let low = Infinity;
  let high = -Infinity;
  for (let i = 0; i < values.length; i += 1) {
    if (mask && !mask[i]) continue;
    const value = values[i];
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return low <= high ? [low, high] : null;
}

/** Value below which a share of the finite magnitudes lies, from an even choice of some thousand. */
export function magnitudeQuantile(values, share, mask = null) {
  const step = Math.max(1, Math.floor(values.length / 8000));
  const all = new Float32Array(Math.ceil(values.length / step));
  let count = 0;
  for (let i = 0; i < values.length; i += step) {
    if (mask && !mask[i]) continue;
    const size = Math.abs(values[i]);
    if (!(size < Infinity)) continue;
    all[count] = size;
    count += 1;
  }
  if (count === 0) return 1;
  const sizes = all.subarray(0, count).sort();
  return sizes[Math.min(count - 1, Math.floor(share * count))] || 1e-9;
}

/** Distinct finite values in order, or null where there are more than `most`. */
export function distinct(values, most) {
  const found = new Set();
  for (let i = 0; i < values.length; i += 1) {
    const value = values[i];
    if (value === value) found.add(value);
    if (found.size > most) return null;
  }
  return [...found].sort((a, b) => a - b);
}

/** Bin of every reading: index, or -1. */
export function binIndex(values, low, high, bins) {
  const index = new Int16Array(values.length);
  const scale = bins / (high - low || 1);
  for (let i = 0; i < values.length; i += 1) {
    const value = values[i];
    if (!(value >= low && value <= high)) {
      index[i] = -1;
      continue;
    }
    const k = Math.floor((value - low) * scale);
    index[i] = k >= bins ? bins - 1 : k;
  }
  return index;
}

/**
 * Means in bins with their standard deviations. Readings of one line count together, since neighbours share their
 * noise: the deviation of a mean is that of the sums of its lines. `weight` (of a displacement along an axis: what the
 * reading feels of it) makes the mean a least-squares estimate; `mask` chooses readings.
 */
export function meansInBins(index, bins, values, lines, { mask = null, weight = null } = {}) {
  const sums = new Float64Array(bins);
  const squares = new Float64Array(bins);
  const counts = new Uint32Array(bins);
  for (let i = 0; i < index.length; i += 1) {
    const k = index[i];
    const value = values[i];
    if (k < 0 || value !== value || (mask && !mask[i])) continue;
    const a = weight ? weight[i] : 1;
    if (a !== a) continue;
    sums[k] += a * value;
    squares[k] += a * a;
    counts[k] += 1;
  }
  const mean = new Float64Array(bins).fill(NaN);
  for (let k = 0; k < bins; k += 1) if (squares[k] > 1e-9) mean[k] = sums[k] / squares[k];
  return { mean, u: deviations(index, bins, values, lines, mask, weight, mean, squares), count: counts };
}

function deviations(index, bins, values, lines, mask, weight, mean, squares) {
  const lineCount = lines ? lines.count : 0;
  const within = new Float64Array(bins * Math.max(1, lineCount));
  const touched = new Uint8Array(lineCount > 0 ? within.length : 0);
  const scatter = new Float64Array(bins);
  for (let i = 0; i < index.length; i += 1) {
    const k = index[i];
    const value = values[i];
    if (k < 0 || value !== value || (mask && !mask[i])) continue;
    const a = weight ? weight[i] : 1;
    if (a !== a) continue;
    const off = a * (value - a * mean[k]);
    scatter[k] += off * off;
    if (lineCount > 0) {
      const at = k * lineCount + lines.index[i];
      within[at] += off;
      touched[at] = 1;
    }
  }
  const u = new Float64Array(bins).fill(NaN);
  for (let k = 0; k < bins; k += 1) {
    if (!(squares[k] > 1e-9)) continue;
    let sum = 0;
    let groups = 0;
    for (let m = k * lineCount; m < (k + 1) * lineCount; m += 1) {
      sum += within[m] * within[m];
      groups += touched[m];
    }
    const clustered = groups >= 3 ? (sum * groups) / (groups - 1) : 0;
    u[k] = Math.sqrt(Math.max(clustered, scatter[k])) / squares[k];
  }
  return u;
}

/** Lines numbered from zero over all set-ups. */
export function numberLines(setup, line) {
  const index = new Int32Array(setup.length);
  const seen = new Map();
  for (let i = 0; i < setup.length; i += 1) {
    const key = setup[i] * 1e6 + (line[i] === line[i] ? line[i] : -1);
    let number = seen.get(key);
    if (number === undefined) {
      number = seen.size;
      seen.set(key, number);
    }
    index[i] = number;
  }
  return { index, count: seen.size };
}

/** How far the marked readings lie from the rest in a column, in pooled standard deviations. */
export function standardisedDifference(values, marked, among = null) {
  const n = [0, 0];
  const sum = [0, 0];
  const square = [0, 0];
  for (let i = 0; i < values.length; i += 1) {
    const value = values[i];
    if (value !== value || (among && !among[i])) continue;
    const k = marked[i] ? 1 : 0;
    n[k] += 1;
    sum[k] += value;
    square[k] += value * value;
  }
  if (n[0] < 3 || n[1] < 3) return 0;
  const mean = [sum[0] / n[0], sum[1] / n[1]];
  const variance = [square[0] / n[0] - mean[0] ** 2, square[1] / n[1] - mean[1] ** 2];
  const pooled = Math.sqrt(Math.max(0, variance[0] + variance[1]) / 2);
  const off = Math.abs(mean[1] - mean[0]);
  if (off === 0) return 0;
  return pooled > 1e-9 * off ? Math.min(20, off / pooled) : 20;
}

/** Counts in bins. */
export function histogram(values, low, high, bins, mask = null) {
  const counts = new Float64Array(bins);
  const scale = bins / (high - low || 1);
  for (let i = 0; i < values.length; i += 1) {
    if (mask && !mask[i]) continue;
    const k = Math.floor((values[i] - low) * scale);
    if (k >= 0 && k < bins) counts[k] += 1;
  }
  return counts;
}

/** How many readings cover every pixel of a box with `edge` pixels around it, each a square of `size` pixels. */
export function countPixels({ column, row, w, h }, size, edge, mask = null) {
  const width = w + 2 * edge;
  const counts = new Uint16Array(width * (h + 2 * edge));
  const off = edge - Math.floor(size / 2);
  let largest = 0;
  for (let i = 0; i < column.length; i += 1) {
    if (column[i] < 0 || (mask && !mask[i])) continue;
    let at = (row[i] + off) * width + column[i] + off;
    for (let j = 0; j < size; j += 1, at += width) {
      for (let k = at; k < at + size; k += 1) {
        const count = (counts[k] += 1);
        if (count > largest) largest = count;
      }
    }
  }
  return { counts, largest, width, height: h + 2 * edge };
}
