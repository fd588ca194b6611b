// Least squares of three displacements over the readings of a cell.

const kLeastReadings = 4;
const kRidge = 0.02; // of the trace: directions that the readings hardly feel stay near zero

/** Cells of the volume, about 5 on its longest side, and the cell of every reading. */
export function gridOf(points, low, high, length) {
  const extent = low.map((v, k) => high[k] - v);
  const size = Math.max(...extent, 1e-9) / (length > 3000 ? 6 : 5);
  const counts = extent.map((e) => Math.max(1, Math.round(e / size)));
  const cells = new Int32Array(length);
  for (let i = 0; i < length; i += 1) {
    let at = 0;
    for (let k = 2; k >= 0; k -= 1) {
      const share = (points[k][i] - low[k]) / (extent[k] || 1);
      const m = Math.min(counts[k] - 1, Math.floor(share * counts[k]));
      if (!(m >= 0)) {
        at = -1;
        break;
      }
      at = at * counts[k] + m;
    }
    cells[i] = at;
  }
  return { cells, points, total: counts[0] * counts[1] * counts[2] };
}

/** Solution of a symmetric system of three, by Cramer's rule. */
export function solve3([a, b, c, d, e, f], [x, y, z]) {
  const det = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d);
  if (!(Math.abs(det) > 0)) return [0, 0, 0];
  return [
    (x * (d * f - e * e) - b * (y * f - e * z) + c * (y * e - d * z)) / det,
    (a * (y * f - e * z) - x * (b * f - c * e) + c * (b * z - y * c)) / det,
    (a * (d * z - y * e) - b * (b * z - y * c) + x * (b * e - c * d)) / det,
  ];
}

/** [{ centre, vector, count }] of the cells that hold enough readings. */
export function cellVectors({ cells, points, total }, residual, along, sigma, mask) {
  const sums = new Float64Array(total * 13);
  for (let i = 0; i < cells.length; i += 1) {
    if (cells[i] < 0 || !mask[i]) continue;
    const [ax, ay, az] = [along[0][i], along[1][i], along[2][i]];
    const r = residual[i];
    if (r !== r || ax !== ax) continue;
    const w = sigma && sigma[i] > 0 ? 1 / (sigma[i] * sigma[i]) : 1;
    const at = 13 * cells[i];
    sums[at] += w * ax * ax;
    sums[at + 1] += w * ax * ay;
    sums[at + 2] += w * ax * az;
    sums[at + 3] += w * ay * ay;
    sums[at + 4] += w * ay * az;
    sums[at + 5] += w * az * az;
    sums[at + 6] += w * ax * r;
    sums[at + 7] += w * ay * r;
    sums[at + 8] += w * az * r;
    for (let k = 0; k < 3; k += 1) sums[at + 9 + k] += points[k][i];
    sums[at + 12] += 1;
  }
  const list = [];
  for (let cell = 0; cell < total; cell += 1) {
    const s = sums.subarray(13 * cell, 13 * cell + 13);
    const count = s[12];
    const trace = s[0] + s[3] + s[5];
    if (count < kLeastReadings || !(trace > 0)) continue;
    const ridge = kRidge * trace;
    list.push({ count, centre: [s[9] / count, s[10] / count, s[11] / count], vector: solve3([s[0] + ridge, s[1], s[2], s[3] + ridge, s[4], s[5] + ridge], [s[6], s[7], s[8]]) });
  }
  return list;
}
