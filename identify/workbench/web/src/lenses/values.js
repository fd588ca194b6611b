// What a lens draws of the residuals: the readings, or the displacement of the functional point that they ask for.
const kLeast = 0.35; // of a displacement: a reading that feels less of it says little on it

export const kOf = [['reading', 'readings'], ['x', 'shift along X'], ['y', 'shift along Y'], ['z', 'shift along Z']];

const made = new WeakMap();

function remembered(residual, key, make) {
  if (!made.has(residual)) made.set(residual, new Map());
  const kept = made.get(residual);
  if (!kept.has(key)) kept.set(key, make());
  return kept.get(key);
}

function divided(values, by) {
  const out = new Float32Array(values.length);
  for (let i = 0; i < values.length; i += 1) out[i] = values[i] / by[i];
  return out;
}

function asDisplacement(values, felt) {
  const out = new Float32Array(values.length);
  for (let i = 0; i < values.length; i += 1) out[i] = Math.abs(felt[i]) >= kLeast ? values[i] / felt[i] : NaN;
  return out;
}

export const namesOf = (config) => (config.of && config.of !== 'reading' ? [`along_${config.of}`] : []);

/** { values: for means, weight: of them or null, dots: what a single reading is drawn at } of one residual. */
export function valuesOf(view, config, residual) {
  const perSigma = config.perSigma && view.sigma;
  const values = perSigma ? remembered(residual, 'sigma', () => divided(residual, view.sigma)) : residual;
  const weight = config.of && config.of !== 'reading' ? view.column(`along_${config.of}`) : null;
  const dots = weight ? remembered(residual, `${config.of} ${perSigma ? 's' : ''}`, () => asDisplacement(values, weight)) : values;
  return { values, weight, dots };
}

export const unitOf = (view, config) => (config.perSigma ? 'stated σ' : view.unit);
export const titleOfValues = (view, config) => `${config.of && config.of !== 'reading' ? `along ${config.of.toUpperCase()}` : 'residual'} [${unitOf(view, config)}]`;

/** What a suspect explains of a reading: the residual now less the one with it. */
export const explained = (now, preview) => remembered(preview, 'explained', () => {
  const out = new Float32Array(now.length);
  for (let i = 0; i < now.length; i += 1) out[i] = now[i] - preview[i];
  return out;
});
