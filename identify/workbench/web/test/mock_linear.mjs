// Least squares of a few columns: what the mock program knows of models.
import { catalogue, kSigma } from './mock_campaign.mjs';

export class Linear {
  constructor(columns, length) {
    Object.assign(this, { columns, length, made: new Map() });
    this.weight = Float64Array.from({ length }, () => 1 / kSigma ** 2);
  }

  column(effect) {
    if (!this.made.has(effect.name)) this.made.set(effect.name, Float64Array.from({ length: this.length }, (_, i) => effect.column(this.columns, i)));
    return this.made.get(effect.name);
  }

  dot(a, b) {
    let sum = 0;
    for (let i = 0; i < this.length; i += 1) if (!this.columns.left_out[i]) sum += a[i] * b[i] * this.weight[i];
    return sum;
  }

  /** Amplitudes of `effects` for the readings `y`, their covariance, and what remains. */
  fit(effects, y) {
    const list = effects.map((effect) => this.column(effect));
    const inverse = invert(list.map((a) => list.map((b) => this.dot(a, b))));
    const right = list.map((a) => this.dot(a, y));
    const amplitude = inverse.map((row) => row.reduce((sum, v, k) => sum + v * right[k], 0));
    const residual = Float32Array.from(y);
    list.forEach((a, k) => { for (let i = 0; i < this.length; i += 1) residual[i] -= amplitude[k] * a[i]; });
    return { amplitude, u95: inverse.map((row, k) => 1.96 * 1.4 * Math.sqrt(row[k])), residual };
  }

  /** One more effect beside those of the model: amplitude, its U95, gain and the residual with it. */
  score(effects, effect, y) {
    const fit = this.fit([...effects, effect], y);
    const k = effects.length;
    const u = fit.u95[k] / 1.96;
    return { value: fit.amplitude[k], u95: fit.u95[k], mdb: 2.8 * u, gain: 0.5 * (fit.amplitude[k] / u) ** 2, residual: fit.residual };
  }

  cosine(a, b) { return this.dot(a, b) / Math.sqrt(this.dot(a, a) * this.dot(b, b) || 1); }
}

function invert(matrix) {
  const n = matrix.length;
  const work = matrix.map((row, i) => [...row.map((v, k) => v + (i === k ? 1e-9 : 0)), ...Array.from({ length: n }, (_, k) => (i === k ? 1 : 0))]);
  for (let c = 0; c < n; c += 1) {
    const pivot = work.slice(c).reduce((best, row, k) => (Math.abs(row[c]) > Math.abs(work[best][c]) ? c + k : best), c);
    [work[c], work[pivot]] = [work[pivot], work[c]];
    const scale = work[c][c];
    work[c] = work[c].map((v) => v / scale);
    for (let r = 0; r < n; r += 1) {
      if (r === c) continue;
      const factor = work[r][c];
      work[r] = work[r].map((v, k) => v - factor * work[c][k]);
    }
  }
  return work.map((row) => row.slice(n));
}

export const effectNamed = (name) => catalogue.find((effect) => effect.name === name);
