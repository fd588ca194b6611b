// A simulated campaign for the page's tests: readings along and about a machine, three effects that its model lacks.
// Even pseudo-random numbers, the same on every run.
function generator(seed) {
  let s = seed >>> 0;
  return () => {
    s = (Math.imul(s, 1664525) + 1013904223) >>> 0;
    return s / 2 ** 32;
  };
}

const random = generator(21);
const normal = () => Math.sqrt(-2 * Math.log(1 - random())) * Math.cos(2 * Math.PI * random());

const kSetups = [
  { name: 'P1_short', instrument: 'laser-tracer', station: [-375, -285, -397], unit: 'um' },
  { name: 'P2_short', instrument: 'laser-tracer', station: [380, -318, -459], unit: 'um' },
  { name: 'P3_side', instrument: 'laser-tracer', station: [344, 328, -440], unit: 'um' },
  { name: 'P4_side', instrument: 'laser-tracer', station: [-350, 310, -420], unit: 'um' },
  { name: 'bar_XY', instrument: 'ball-bar', plane: [0, 1], unit: 'um', bar: true },
  { name: 'bar_YZ', instrument: 'ball-bar', plane: [1, 2], unit: 'um', bar: true },
  { name: 'pitch_X', instrument: 'angle', unit: 'urad' },
];
export const kRadius = 150;
export const kSigma = 0.45;
const kLine = 24; // readings in a line

const unit = (v) => v.map((c) => c / Math.hypot(...v));

function linePoint(setup, line, k) {
  const axis = line % 3;
  const sign = Math.floor(line / 3) % 2 === 0 ? 1 : -1;
  const start = [-250 + 500 * random(), -200 + 400 * random(), -400 + 400 * random()];
  return { axis, sign, start, at: (m) => start.map((c, a) => (a === axis ? [-250, -200, -400][a] + ([500, 400, 400][a] * (sign > 0 ? m : kLine - 1 - m)) / (kLine - 1) : c)), k };
}

/** Columns of `length` readings. */
export function simulate(length) {
  const names = ['x', 'y', 'z', 'dir_x', 'dir_y', 'dir_z', 'time', 'T_air', 'T_column', 'setup', 'row', 'channel', 'line', 'point_x', 'point_y', 'point_z', 'along_x', 'along_y', 'along_z', 'angle', 'sense', 'stated_sigma', 'heldout', 'left_out', 'noise'];
  const columns = Object.fromEntries(names.map((name) => [name, new Float32Array(length)]));
  columns.angle.fill(NaN);
  columns.sense.fill(NaN);
  let path = null;
  let drift = 0;
  for (let i = 0; i < length; i += 1) {
    const s = Math.min(kSetups.length - 1, Math.floor((i * kSetups.length) / length));
    const setup = kSetups[s];
    const line = Math.floor(i / kLine);
    const k = i % kLine;
    if (k === 0 || !path) {
      path = linePoint(setup, line, k);
      drift = 0.15 * normal();
    }
    const first = i % Math.ceil(length / kSetups.length);
    let point = path.at(k);
    let direction = [0, 1, 2].map((a) => (a === path.axis ? path.sign : 0));
    let along;
    if (setup.bar) {
      const turn = (first / 180) * 2 * Math.PI;
      const sense = Math.floor(first / 180) % 2 === 0 ? 1 : -1;
      const angle = sense * turn;
      const [a, b] = setup.plane;
      along = [0, 0, 0];
      [along[a], along[b]] = [Math.cos(angle), Math.sin(angle)];
      point = [0, 0, -200];
      point[a] += kRadius * along[a];
      point[b] += kRadius * along[b];
      direction = [0, 0, 0];
      [direction[a], direction[b]] = [Math.sign(-sense * along[b]), Math.sign(sense * along[a])];
      columns.angle[i] = ((angle * 180) / Math.PI) % 360;
      columns.sense[i] = sense;
    } else along = setup.station ? unit(point.map((c, a) => c - setup.station[a])) : [0, 0, 0];
    ['x', 'y', 'z'].forEach((name, a) => {
      columns[name][i] = point[a];
      columns[`point_${name}`][i] = point[a];
      columns[`dir_${name}`][i] = direction[a];
      columns[`along_${name}`][i] = along[a];
    });
    const time = 4 * i * Math.min(1, 6048 / length);
    Object.entries({ time, T_air: 20 + 0.8 * Math.sin(time / 4000) + 0.05 * normal(), T_column: 20.3 + time / 24000 + 0.02 * normal(), setup: s, row: i, channel: 0, line, stated_sigma: kSigma, heldout: line % 10 === 9 ? 1 : 0 })
      .forEach(([name, value]) => { columns[name][i] = value; });
    columns.noise[i] = kSigma * 0.9 * normal() + drift;
  }
  return { columns, setups: kSetups };
}

export const bump = (x, z) => 2.2 * Math.exp(-(((x - 90) / 80) ** 2) - (((z + 260) / 90) ** 2));

const felt = (axis, law) => (c, i) => c[`along_${axis}`][i] * law(c, i);
const angular = (c, i) => (c.setup[i] === 6 ? 1 : 0);

/** Names that the catalogue has; `column` is what an amplitude of one adds to a reading. */
export const catalogue = [
  ...['x', 'y', 'z'].map((a) => ({
    name: `reversal:E${a.toUpperCase().repeat(2)}:dir_${a}:step`, label: `reversal E${a.toUpperCase().repeat(2)}`, unit: 'um', shape: 'step', words: `${a.toUpperCase()} stops apart depending on the side it comes from; usual causes: backlash of the ball screw, a loose coupling, stick-slip of the guide.`,
    column: felt(a, (c, i) => 0.5 * c[`dir_${a}`][i]), sketch: [[-1, -0.5], [0, -0.5], [0, 0.5], [1, 0.5]],
  })),
  ...['x', 'y', 'z'].flatMap((a) => ['cos', 'sin'].map((wave) => ({
    name: `cyclic:E${a.toUpperCase().repeat(2)}:${a}:10mm:${wave}`, label: `cyclic E${a.toUpperCase().repeat(2)} ${wave}`, unit: 'um', shape: 'period 10.02 mm', words: `${a.toUpperCase()} deviates in a wave that repeats with the pitch of the screw; usual causes: eccentric screw or encoder, interpolation error.`,
    column: felt(a, (c, i) => Math[wave]((2 * Math.PI * c[a][i]) / 10.02)), sketch: Array.from({ length: 25 }, (_, k) => [k, Math[wave](k / 3)]),
  }))),
  ...['x', 'y', 'z'].map((a) => ({
    name: `thermal:E${a.toUpperCase().repeat(2)}:T_column:linear`, label: `thermal E${a.toUpperCase().repeat(2)}`, unit: 'um/K', shape: 'linear', words: `The scale of ${a.toUpperCase()} grows with the temperature of the column; usual causes: scale not compensated, warm screw.`,
    column: felt(a, (c, i) => (c.T_column[i] - 20) * (c[a][i] / 250)), sketch: [[0, 0], [1, 1]],
  })),
  { name: 'sag:EZX:x:quadratic', label: 'sag EZX', unit: 'um', shape: 'quadratic', words: 'Z sinks in the middle of X; usual causes: beam bends, guide is bent.', column: felt('z', (c, i) => (c.x[i] / 250) ** 2), sketch: Array.from({ length: 11 }, (_, k) => [k - 5, (k - 5) ** 2]) },
  { name: 'pitch:EBX:dir_x:step', label: 'reversal EBX', unit: 'urad', shape: 'step', words: 'X tilts when it turns round; usual causes: play of the guide.', column: (c, i) => angular(c, i) * 0.5 * c.dir_x[i], sketch: [[-1, -0.5], [0, -0.5], [0, 0.5], [1, 0.5]] },
  { name: 'empirical:y:x:z', label: 'surface of x and z along Y', unit: 'um', shape: 'surface', words: 'A smooth function of x and z along Y, found by the readings alone.', hidden: true, surface: true, column: felt('y', (c, i) => bump(c.x[i], c.z[i])), sketch: [] },
];

export const truth = { 'reversal:EYY:dir_y:step': 3.2, 'cyclic:EXX:x:10mm:sin': 0.5, 'empirical:y:x:z': 1, 'pitch:EBX:dir_x:step': 1.5 };
export const rivalsOf = { 'cyclic:EXX:x:10mm:sin': ['cyclic EXX cos'], 'sag:EZX:x:quadratic': ['thermal EZZ'] };
export const unseen = [
  { name: 'pivot:A:offset', label: 'offset of pivot A', amplitudes: [], words: '', visible: 0, remedy: 'Measure with A at three angles at least.' },
  { name: 'history:EYY:spindle_speed', label: 'EYY after the spindle has run', amplitudes: [], words: '', visible: 0, remedy: 'Record spindle_speed and measure after an hour at speed.' },
];
