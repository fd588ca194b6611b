import { choice } from '../dom.js';

/** Which of the models a section shows, the last at first; `box.index` is the chosen one. Nothing to choose of one. */
export function modelChoice(names, onChange) {
  const box = { index: names.length - 1, node: null };
  if (names.length < 2) return box;
  const order = names.map((name, m) => [m, `${'AB'[m]}: ${name}`]).reverse();
  box.node = choice('Predicted by', order, (value) => {
    box.index = Number(value);
    onChange();
  });
  return box;
}
