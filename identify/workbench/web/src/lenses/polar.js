// A circle of the ball-bar, drawn as in the reports; what is marked and looked at is drawn above it.
import { fixed } from '../../../../report/web/src/dom.js';
import { polarFigure, polarGeometry } from '../../../../report/web/src/lenses/polar.js';
import { alpha, hex, kMarked, kPreview } from '../draw/palette.js';

const kMargin = 4; // of the plot, in pixels
const kMostDrawn = 4000;

/** Set-ups that are circles. */
export const circlesOf = (setups) => setups.map((setup, index) => ({ ...setup, index })).filter((setup) => setup.bar);

const indexed = new WeakMap();

/** Observation of every row of a set-up. */
function observationsOf(view, index) {
  const [setup, row] = [view.column('setup'), view.column('row')];
  if (!indexed.has(row)) indexed.set(row, new Map());
  const known = indexed.get(row);
  if (!known.has(index)) {
    const of = new Map();
    for (let i = 0; i < setup.length; i += 1) if (setup[i] === index) of.set(row[i], i);
    known.set(index, of);
  }
  return known.get(index);
}

/** The readings of a circle that are shown: [{ i: observation, angle, sense }]. */
function readingsOf(view, circle) {
  const of = observationsOf(view, circle.setup);
  const all = circle.rows.map((row, k) => ({ i: of.get(row), angle: circle.angle_deg[k], sense: circle.sense[k] })).filter(({ i }) => i !== undefined && view.shown[i]);
  const step = Math.ceil(all.length / kMostDrawn);
  return step > 1 ? all.filter((_, k) => k % step === 0) : all;
}

const sidesOf = ({ plane }) => ({ first: plane?.[0] ?? 'X', second: plane?.[1] ?? 'Y' });

/** Measured and predicted as the program gives them. */
const readingsData = (circle) => ({
  ...sidesOf(circle), angle: circle.angle_deg, sense: circle.sense,
  traces: [{ name: 'measured', values: circle.measured_um, opacity: 0.75 }, { name: 'predicted', values: circle.predicted_um, dash: '5px,3px', width: 2.2 }],
});

const residualData = (view, list, circle) => ({
  ...sidesOf(circle), angle: list.map(({ angle }) => angle), sense: list.map(({ sense }) => sense),
  traces: [
    ...(view.before ? [{ name: 'before', values: list.map(({ i }) => view.before[i]), shade: 'muted', opacity: 0.6, width: 1.2 }] : []),
    { name: 'now', values: list.map(({ i }) => view.now[i]) },
  ],
});

function prepare(view, config, size) {
  const setups = circlesOf(view.setups);
  if (setups.length === 0) return { empty: 'This campaign has no ball-bar.' };
  if (!config.circles || !view.column('row')) return null;
  const circle = config.circles.find(({ setup }) => setup === Number(config.circle)) ?? config.circles[0];
  const list = circle ? readingsOf(view, circle) : [];
  if (list.length === 0) return { empty: 'None of the readings that are shown lies on this circle.' };
  const data = config.what === 'readings' ? readingsData(circle) : residualData(view, list, circle);
  const geometry = polarGeometry(data.traces);
  const [w, h] = [size.width - 2 * kMargin, size.height - 2 * kMargin];
  const scale = Math.min(w, h) / (2 * geometry.limit);
  const place = (angle, value) => {
    const [x, y] = geometry.place(angle, value);
    return [size.width / 2 + scale * x, size.height / 2 - scale * y];
  };
  return { view, list, place, centre: [size.width / 2, size.height / 2], readings: config.what === 'readings', figure: () => polarFigure(data, size.height) };
}

function drawOverlay(ctx, scene, { selection, preview }) {
  if (scene.empty || scene.readings) return;
  const { list, place, view } = scene;
  if (preview && preview.residual.length === view.length) {
    ctx.fillStyle = hex(kPreview);
    for (const { i, angle } of list) {
      const [x, y] = place(angle, preview.residual[i]);
      ctx.fillRect(x - 1, y - 1, 2, 2);
    }
  }
  if (!selection.mask) return;
  ctx.fillStyle = alpha(kMarked, 0.9);
  for (const { i, angle } of list) {
    if (!selection.mask[i]) continue;
    const [x, y] = place(angle, view.now[i]);
    ctx.fillRect(x - 2, y - 2, 4, 4);
  }
}

/** Readings that lie in the rectangle. */
function brush(scene, { x0, x1, y0, y1 }) {
  if (scene.empty || scene.readings) return null;
  const { view, place, list } = scene;
  const inside = new Set(list.filter(({ i, angle }) => {
    const [x, y] = place(angle, view.now[i]);
    return x >= x0 && x <= x1 && y >= y0 && y <= y1;
  }).map(({ i }) => i));
  return (i) => inside.has(i);
}

function readout(scene, x, y) {
  if (scene.empty) return scene.empty;
  const [cx, cy] = scene.centre;
  return `${fixed((Math.atan2(cy - y, x - cx) * 180) / Math.PI, 0)}° on the circle`;
}

export const polar = {
  kind: 'polar', title: 'ball-bar circle', controls: ['circle', 'what'], asks: 'polar', library: true,
  needs: () => ['row'], prepare, drawBase: () => {}, drawOverlay, brush, readout, brushBox: () => null,
};
