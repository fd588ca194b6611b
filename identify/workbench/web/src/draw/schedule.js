// Drawing at most once a frame, however often something changes.
const waiting = new Set();
let asked = false;
const after = new Set();

function run() {
  asked = false;
  const now = [...waiting];
  waiting.clear();
  for (const draw of now) draw();
  const done = [...after];
  after.clear();
  for (const tell of done) tell();
}

export function nextFrame(draw) {
  waiting.add(draw);
  if (asked) return;
  asked = true;
  requestAnimationFrame(run);
}

/** Calls `tell` when what waits now is drawn. */
export function whenDrawn(tell) {
  after.add(tell);
  nextFrame(() => {});
}

export const forget = (draw) => waiting.delete(draw);
