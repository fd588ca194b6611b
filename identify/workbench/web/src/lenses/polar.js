// A circle of the ball-bar, drawn as in the reports; what is marked and looked at is drawn above it.
import { fixed } from '../../../../report/web/src/dom.js';
import { polarFigure, polarGeometry } from '../../../../report/web/src/lenses/polar.js';
import { alpha, hex, kMarked, kPreview } from '../draw/palette.js';

const kMargin = 4; // of the plot, in pixels
const kMostDrawn = 4000;

/** Set-ups that are circles. */
export const circlesOf = (setups) => setups.map((setup, index) => ({ ...setup, index })).filter((setup) => setup.bar);

function rowsOf(view, index) {
  const [setup, angle] = [view.column('setup'), view.column('angle')];
  const rows = [];
  for (let i = 0; i < setup.length; i += 1) if (setup[i] === index && angle[i] === angle[i] && view.shown[i]) rows.push(i);
  const step = Math.ceil(rows.length / kMostDrawn);
  return step > 1 ? rows.filter((_, k) => k % step === 0) : rows;
}

const residualTraces = (view, rows) => [
  ...(view.before ? [{ name: 'before', values: rows.map((i) => view.before[i]), shade: 'muted', opacity: 0.6, width: 1.2 }] : []),
  { name: 'now', values: rows.map((i) => view.now[i]) },
];

/** Measured and predicted as the program gives them. */
function readingsData(circle) {
  return {
    first: circle.first ?? 'X', second: circle.second ?? 'Y', angle: circle.angle_deg, sense: circle.sense,
    traces: [{ name: 'measured', values: circle.measured_um, opacity: 0.75 }, { name: 'predicted', values: circle.predicted_um, dash: '5px,3px', width: 2.2 }],
  };
}

function residualData(view, rows, circle) {
  const [angle, sense] = [view.column('angle'), view.column('sense')];
  return { first: circle?.first ?? 'X', second: circle?.second ?? 'Y', angle: rows.map((i) => angle[i]), sense: rows.map((i) => (sense[i] < 0 ? -1 : 1)), traces: residualTraces(view, rows) };
}

function prepare(view, config, size) {
  const setups = circlesOf(view.setups);
  if (setups.length === 0) return { empty: 'This campaign has no ball-bar.' };
  if (!view.column('angle') || !view.column('sense')) return null;
  const setup = setups.find(({ index }) => index === Number(config.circle)) ?? setups[0];
  const circle = config.circles?.find(({ name }) => name === setup.name);
  const rows = rowsOf(view, setup.index);
  if (rows.length === 0) return { empty: 'None of the readings that are shown lies on this circle.' };
  const data = config.what === 'readings' && circle ? readingsData(circle) : residualData(view, rows, circle);
  const geometry = polarGeometry(data.traces);
  const [w, h] = [size.width - 2 * kMargin, size.height - 2 * kMargin];
  const scale = Math.min(w, h) / (2 * geometry.limit);
  const place = (angle, value) => {
    const [x, y] = geometry.place(angle, value);
    return [size.width / 2 + scale * x, size.height / 2 - scale * y];
  };
  return { view, rows, data, place, centre: [size.width / 2, size.height / 2], readings: config.what === 'readings', figure: () => polarFigure(data, size.height), angle: view.column('angle') };
}

function drawOverlay(ctx, scene, { selection, preview }) {
  if (scene.empty || scene.readings) return;
  const { rows, place, angle, view } = scene;
  if (preview && preview.residual.length === view.length) {
    ctx.fillStyle = hex(kPreview);
    for (const i of rows) {
      const [x, y] = place(angle[i], preview.residual[i]);
      ctx.fillRect(x - 1, y - 1, 2, 2);
    }
  }
  if (!selection.mask) return;
  ctx.fillStyle = alpha(kMarked, 0.9);
  for (const i of rows) {
    if (!selection.mask[i]) continue;
    const [x, y] = place(angle[i], view.now[i]);
    ctx.fillRect(x - 2, y - 2, 4, 4);
  }
}

/** Readings that lie in the rectangle. */
function brush(scene, { x0, x1, y0, y1 }) {
  if (scene.empty || scene.readings) return null;
  const { view, angle, place, rows } = scene;
  const inside = new Set(rows.filter((i) => {
    const [x, y] = place(angle[i], view.now[i]);
    return x >= x0 && x <= x1 && y >= y0 && y <= y1;
  }));
  return (i) => inside.has(i);
}

function readout(scene, x, y) {
  if (scene.empty) return scene.empty;
  const [cx, cy] = scene.centre;
  return `${fixed((Math.atan2(cy - y, x - cx) * 180) / Math.PI, 0)}° on the circle`;
}

export const polar = {
  kind: 'polar', title: 'ball-bar circle', controls: ['circle', 'what'], asks: 'polar', library: true,
  needs: () => ['angle', 'sense'], prepare, drawBase: () => {}, drawOverlay, brush, readout, brushBox: () => null,
};
