// Shapes as a reader knows them, for effects whose drawing the program does not send.
const sampled = (law) => Array.from({ length: 33 }, (_, k) => [k / 16 - 1, law(k / 16 - 1)]);

const kShapes = [
  [/pre-travel|settl|lost motion that fades/, sampled((x) => (x < 0 ? 0 : Math.exp(-5 * x)))],
  [/late|lag|memory|warm/, sampled((x) => (x < 0 ? 0 : 1 - Math.exp(-4 * x)))],
  [/reversal|backlash|step/, sampled((x) => (x < 0 ? -1 : 1))],
  [/period|cyclic|subdivision|wave|eccentric|wobble/, sampled((x) => Math.sin(9 * x))],
  [/\^2|curved|sag|bend/, sampled((x) => x * x)],
  [/\^3/, sampled((x) => x ** 3)],
  [/ by |expansion|linear|lead|scale|growing|dead path|drift/, sampled((x) => x)],
];

/** [[driver, value], ...] of an effect by its kind and shape; null where these name none. */
export function sketchOf({ kind = '', label = '', shape = '' }) {
  const text = `${kind} ${label} ${shape}`;
  return kShapes.find(([words]) => words.test(text))?.[1] ?? null;
}
