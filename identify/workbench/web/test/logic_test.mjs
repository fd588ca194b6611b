// What the page computes itself, without a browser: node logic_test.mjs
import assert from 'node:assert/strict';
import test from 'node:test';
import { eventParser } from '../src/api/events_text.js';
import { readFrame, writeFrame } from '../src/api/frames.js';
import { indices, mark, meanOf, sharedValue, standOut } from '../src/data/selection.js';
import { binIndex, countPixels, histogram, magnitudeQuantile, meansInBins, numberLines, rangeOf, standardisedDifference } from '../src/data/statistics.js';
import { sketchOf } from '../src/data/sketch.js';
import { outlineOf, surfaceData } from '../src/data/surface.js';
import { treeOf } from '../src/data/tree.js';
import { directionWords, stepsOf, unitText, variablesOf } from '../src/data/variables.js';
import { linear, niceTicks } from '../src/draw/scale.js';
import { cellVectors, gridOf, solve3 } from '../src/lenses/vector_cells.js';
import { bytesBefore, caretLine, columnOfByte, placeOfByte, taken } from '../src/panels/completion.js';

const near = (a, b, off = 1e-6) => assert.ok(Math.abs(a - b) <= off, `${a} is not ${b}`);

test('framed columns come back as they were written, on four-byte boundaries', () => {
  const bytes = writeFrame({ model: 2 }, { a: Float32Array.of(1, NaN, 3), 'residual@2': Float32Array.of(-0.5, 0.25, 8) });
  const { head, columns } = readFrame(bytes.buffer);
  assert.equal(head.model, 2);
  assert.deepEqual(head.columns, ['a', 'residual@2']);
  assert.deepEqual([...columns['residual@2']], [-0.5, 0.25, 8]);
  assert.ok(Number.isNaN(columns.a[1]));
  assert.deepEqual(readFrame(writeFrame({ x: 1 }, {}).buffer).columns, {});
});

test('events are read in pieces, comments are passed over', () => {
  const seen = [];
  const feed = eventParser((name, data) => seen.push([name, data]));
  for (const part of [': beat\n\nevent: pro', 'gress\ndata: {"share"', ': 0.5}\r\n\r\ndata: {"a": 1}\n\n', ': beat\n\n']) feed(part);
  assert.deepEqual(seen, [['progress', { share: 0.5 }], ['message', { a: 1 }]]);
});

test('means in bins, and their deviations', () => {
  const x = Float32Array.of(0, 0.1, 0.9, 1);
  const index = binIndex(x, 0, 1, 2);
  assert.deepEqual([...index], [0, 0, 1, 1]);
  const means = meansInBins(index, 2, Float32Array.of(1, 3, 5, 5), null);
  assert.deepEqual([...means.mean], [2, 5]);
  near(means.u[0], Math.sqrt(2) / 2);
  near(means.u[1], 0);
  assert.deepEqual([...binIndex(Float32Array.of(NaN, 2), 0, 1, 4)], [-1, -1]);
});

test('readings of a line count together', () => {
  // Four lines of two equal readings each: the deviation is that of four values, sqrt(n / (n - 1)) times their scatter.
  const values = Float32Array.of(1, 1, -1, -1, 1, 1, -1, -1);
  const lines = numberLines(new Float32Array(8), Float32Array.of(0, 0, 1, 1, 2, 2, 3, 3));
  assert.equal(lines.count, 4);
  const { u } = meansInBins(new Int16Array(8), 1, values, lines);
  near(u[0], Math.sqrt((4 * 4 * 4) / 3) / 8);
  near(meanOf(values, new Uint8Array(8).fill(1), lines).u, u[0]);
});

test('a mean over what the readings feel is a least-squares estimate', () => {
  const felt = Float32Array.of(1, -1, 0.5, 0);
  const values = felt.map((a) => 3 * a);
  near(meansInBins(new Int16Array(4), 1, values, null, { weight: felt }).mean[0], 3);
});

test('ranges, quantiles and histograms pass over what is not recorded', () => {
  assert.deepEqual(rangeOf(Float32Array.of(NaN, 2, -1)), [-1, 2]);
  assert.equal(rangeOf(Float32Array.of(NaN)), null);
  near(magnitudeQuantile(Float32Array.from({ length: 101 }, (_, k) => k - 50), 0.5), 25, 1);
  assert.deepEqual([...histogram(Float32Array.of(-1, 0, 0.5, 7, NaN), -1, 1, 2)], [1, 2]);
});

test('dots cover squares of pixels, those at the edge of a box beyond it, and add up', () => {
  const where = { column: Int16Array.of(0, 1, -1, 1), row: Int16Array.of(0, 1, 0, 1), w: 2, h: 2 };
  const { counts, largest, width, height } = countPixels(where, 3, 1);
  assert.deepEqual([width, height, largest], [4, 4, 3]);
  assert.deepEqual([...counts], [1, 1, 1, 0, 1, 3, 3, 2, 1, 3, 3, 2, 0, 2, 2, 2]);
  const marked = countPixels(where, 1, 0, Uint8Array.of(0, 1, 1, 0));
  assert.deepEqual([...marked.counts], [0, 0, 0, 1]);
});

test('marking adds to what is marked or replaces it, among the readings that are shown', () => {
  const shown = Uint8Array.of(1, 1, 0, 1);
  const first = mark(4, shown, (i) => i >= 1);
  assert.deepEqual(indices(first.mask), [1, 3]);
  assert.equal(mark(4, shown, (i) => i === 0, first.mask).count, 3);
  assert.equal(mark(4, shown, () => false).mask, null);
});

test('what the marked readings share, and where they stand out', () => {
  const mask = Uint8Array.of(1, 1, 1, 0, 0, 0);
  const direction = Float32Array.of(-1, -1, -1, 1, -1, 1);
  const x = Float32Array.of(1, 5, 2, 1, 5, 2);
  assert.equal(sharedValue(direction, mask), -1);
  assert.equal(sharedValue(x, mask), null);
  const list = standOut([{ name: 'x' }, { name: 'dir_y' }], { x, dir_y: direction }, mask, null);
  assert.deepEqual(list.map(({ variable }) => variable.name), ['dir_y']);
  near(standardisedDifference(Float32Array.of(1, 1, 1, 0, 0, 0), mask), 20);
});

test('words of variables', () => {
  assert.equal(directionWords({ name: 'dir_y' }, -1), 'all with Y coming towards −');
  assert.equal(unitText('um/K'), 'µm/K');
  assert.equal(unitText('urad'), 'µrad');
  assert.equal(unitText('um/m3'), 'µm/m³');
  assert.equal(unitText('urad/mm5/K2'), 'µrad/mm⁵/K²');
  assert.equal(unitText(null), '');
  assert.deepEqual(stepsOf({ name: 'tool', kind: 'category', values: ['short', 'long'] }, Float32Array.of(0, 1)), { at: [0, 1], text: ['short', 'long'] });
  assert.equal(stepsOf({ name: 'x', kind: 'position' }, Float32Array.of(0, 1)), null);
  assert.deepEqual(stepsOf({ name: 'dir_x', kind: 'direction' }, Float32Array.of(1, -1)).text, ['towards −', 'towards +']);
  assert.equal(variablesOf({ columns: [{ name: 'row' }], setups: [{ name: 'P1' }] }).filter(({ name }) => name === 'row').length, 1);
});

test('the first child of a model stands beside it, others begin rows', () => {
  const places = treeOf([{ number: 0, parent: null }, { number: 1, parent: 0 }, { number: 2, parent: 1 }, { number: 3, parent: 0 }]);
  assert.deepEqual(places.map(({ model, depth, row }) => [model.number, depth, row]), [[0, 0, 0], [1, 1, 0], [2, 2, 0], [3, 1, 1]]);
});

test('a completed word, and the mark below a wrong column', () => {
  assert.deepEqual(taken('EXX += di * 2', 9, 7, 'dir_x'), { text: 'EXX += dir_x * 2', at: 12 });
  assert.equal(caretLine(3), '  ^');
});

test('scales and ticks', () => {
  const scale = linear(0, 10, 100, 0);
  near(scale(2.5), 75);
  near(scale.invert(75), 2.5);
  assert.deepEqual(niceTicks(0, 1, 5).at.map((v) => Number(v.toFixed(6))), [0, 0.2, 0.4, 0.6, 0.8, 1]);
});

test('displacement of a cell is least squares of what its readings feel', () => {
  const [x] = solve3([2, 0, 0, 4, 0, 8], [2, 4, 8]);
  near(x, 1);
  // Three beams along the axes and one along none: displacement (1, 2, -1), but for the ridge.
  const along = [Float32Array.of(1, 0, 0, 1, 0, 0), Float32Array.of(0, 1, 0, 0, 1, 0), Float32Array.of(0, 0, 1, 0, 0, 1)];
  const residual = Float32Array.of(1, 2, -1, 1, 2, -1);
  const points = [0, 1, 2].map(() => new Float32Array(6));
  const [cell] = cellVectors(gridOf(points, [0, 0, 0], [0, 0, 0], 6), residual, along, null, new Uint8Array(6).fill(1));
  assert.equal(cell.count, 6);
  cell.vector.forEach((v, k) => near(v, [1, 2, -1][k], 0.15));
});

test('a surface is drawn with the names and units of its variables, its largest value with its place', () => {
  const data = surfaceData({ label: 's', drivers: ['x', 'z'], unit: 'um', places: [[0, 1], [10, 20, 30]], value: [0, 0, 0, 0, -5, 1], u95: [1, 1, 1, 1, 2, 1], dots: [[0], [10]] }, [{ name: 'x', label: 'X', unit: 'mm' }]);
  assert.deepEqual(data.at, [1, 20]);
  assert.equal(data.largest, -5);
  assert.equal(data.largest_U95, 2);
  assert.equal(data.axes[0].title, 'X [mm]');
});

test('a bump is outlined where half of it is left, at the edge of the drawing where it does not fall', () => {
  const bump = { places: [[-20, -10, 0, 10, 20], [1, 2, 3]], value: [0, -1, -1, 0, -3, -3, 0, -4, -2, 0, -1.9, -2, 0, 0, 0], u95: Array(15).fill(0.5) };
  assert.deepEqual(outlineOf(bump), { largest: -4, u95: 0.5, at: [0, 2], from: [-10, 2], to: [0, 3] });
  assert.deepEqual(outlineOf({ places: [[0, 1, 2]], value: [1, 2, 0.5], u95: [1, 1, 1] }), { largest: 2, u95: 1, at: [1], from: [0], to: [1] });
});

test('an effect is sketched by its kind, one that has no known shape is not', () => {
  const step = sketchOf({ kind: 'reversal', label: 'reversal EXX' });
  assert.deepEqual([step[0][1], step.at(-1)[1]], [-1, 1]);
  assert.ok(sketchOf({ label: 'EXX', shape: 'period 10.02 mm' }).some(([, y]) => y > 0.9));
  assert.equal(sketchOf({ kind: 'other', label: 'EXX' }), null);
});

test('places in a formula are bytes for the program, characters for the page', () => {
  const text = 'EXX += T_Öl';
  assert.equal(bytesBefore(text, 11), 12);
  assert.equal(placeOfByte(text, 7), 7);
  assert.equal(placeOfByte(text, 12), 11);
  assert.equal(columnOfByte('T_Öl * ?', 9), 8);
});
