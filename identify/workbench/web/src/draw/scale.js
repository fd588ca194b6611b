// Scales and their ticks.

export function linear(low, high, from, to) {
  const span = high - low || 1;
  const k = (to - from) / span;
  const scale = (value) => from + (value - low) * k;
  return Object.assign(scale, { low, high, from, to, invert: (pixel) => low + (pixel - from) / k });
}

/** Values at steps of 1, 2 or 5 times a power of ten. */
export function niceTicks(low, high, most) {
  const raw = (high - low) / Math.max(1, most);
  if (!(raw > 0) || !Number.isFinite(raw)) return { at: [low], decimals: 2 };
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999);
  const at = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) at.push(k * step);
  return { at, decimals: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

export const padded = ([low, high], share) => {
  const edge = share * (high - low) || Math.abs(high) * 0.05 || 1;
  return [low - edge, high + edge];
};
