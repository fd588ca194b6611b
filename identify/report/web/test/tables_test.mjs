// Tables of the report: what stays on paper, what comes first, what may break into lines. node --test tables_test.mjs
import assert from 'node:assert/strict';
import test from 'node:test';
import { openPage } from './page_stub.mjs';

openPage('{"pages": []}');
const { el, longTable, table } = await import('../src/dom.js');
const { renderUncertainties } = await import('../src/pages/uncertainties.js');

const rowsOf = (node) => node.querySelectorAll('tr').slice(1);

test('a long table counts the marked rows that paper shows beside the first', () => {
  const rows = Array.from({ length: 30 }, (_, k) => ({ k, marked: k === 3 || k === 25 }));
  const node = longTable([{ name: 'k', cell: (row) => `${row.k}` }], rows, { rowClass: (row) => (row.marked ? 'marked' : null) });
  assert.match(node.textContent, /The first 20 of 30 rows and 1 more that is marked; the others/);
});

test('the values that are not validated stand first', () => {
  const verdicts = [...Array(40).fill('validated'), 'undecided', 'not validated'];
  const others = verdicts.map((verdict, k) => ({ name: `value ${k}`, unit: 'µm', linear: 1, u: k === 41 ? null : 1, bias: 0, bias_error: 1, verdict }));
  const body = el('div');
  renderUncertainties(body, {
    draws: 10, seed: 1, path: 'linear', digits: 2, not_converged: 0, disturbances: [], verdicts: { validated: 40, undecided: 1, not_validated: 1 },
    refits: 0, linear_share: 0, chord_share: 0, held: '', messages: [], functions: [], others,
  });
  const names = rowsOf(body).map((row) => row.querySelectorAll('th')[0].textContent);
  assert.deepEqual(names.slice(0, 4), ['value 41', 'value 40', 'value 0', 'value 1']);
  assert.equal(rowsOf(body)[0].querySelectorAll('td')[2].textContent, '–');
});

test('long texts of a column are told from short ones, and from numbers', () => {
  const node = table([
    { name: 'Not visible', align: 'left', cell: () => 'EXX, EYX, EZX, EAX, EBX' },
    { name: 'Unit', align: 'left', cell: () => 'µm' },
    { name: 'Readings', cell: () => '12345678901234567' },
  ], [{}]);
  assert.equal(rowsOf(node)[0].querySelectorAll('th')[0].getAttribute('class'), 'left words');
  assert.deepEqual(rowsOf(node)[0].querySelectorAll('td').map((cell) => cell.getAttribute('class')), ['left', 'right']);
});
