// The certificate of a compensation: what stands on a sheet that somebody signs.
import { count, el, fixed, note, significant, symbolMark, table } from '../dom.js';
import { figure } from './summary.js';
import { instrumentMark } from '../theme.js';

const missing = () => el('span', { class: 'muted' }, 'not recorded');
const minus = (text) => text.replace(/(^|[\s(])-(?=\d)/g, '$1−');
const stated = (text) => (text === '' ? missing() : minus(text));
const micrometres = (value) => fixed(value, 2);

const facts = (title, rows) => el('div', {}, [
  el('h3', {}, title),
  el('table', { class: 'facts' }, el('tbody', {}, rows.map(([name, value]) =>
    el('tr', {}, [el('th', { scope: 'row' }, name), el('td', {}, stated(value))])))),
]);

export function renderCertified(body, data) {
  body.append(el('div', { class: 'figures' }, data.figures.map(figure)));
  if (data.reservations.length > 0) {
    body.append(el('div', { class: 'status warning' }, [
      el('strong', {}, 'With reservations'),
      el('ul', {}, data.reservations.map((text) => el('li', {}, text))),
    ]));
  }
  body.append(
    el('div', { class: 'columns' }, [facts('Machine', data.machine), facts('Measurement', data.measurement)]),
    facts('Compensation', data.compensation),
    el('h3', {}, 'Instruments'),
    table([
      { name: 'Instrument', align: 'left', cell: (row) => instrumentMark(row.instrument) },
      { name: 'Maker, serial number, calibration', align: 'left', cell: (row) => stated(row.recorded) },
      { name: 'Setups', cell: (row) => count(row.setups) },
      { name: 'Readings', cell: (row) => count(row.readings) },
    ], data.instruments, { className: 'wrapped' }),
  );
}

const leftColumns = [
  { name: 'Error left', align: 'left', cell: (row) => row.name },
  { name: 'RMS', unit: 'µm', cell: (row) => micrometres(row.rms) },
  { name: 'Largest', unit: 'µm', cell: (row) => micrometres(row.max) },
];

const axisColumns = [
  { name: 'Tool axis', unit: 'µrad RMS', cell: (row) => (row.axis === undefined ? '' : fixed(row.axis, 2)) },
  { name: 'Largest', unit: 'µrad', cell: (row) => (row.axis_max === undefined ? '' : fixed(row.axis_max, 2)) },
];

function measuredRows(rows) {
  return rows.flatMap((row) => [['lengths', 'µm'], ['angles', 'µrad']]
    .filter(([kind]) => row[kind])
    .map(([kind, unit]) => ({ ...row, ...row[kind], unit })));
}

function measuredTable(rows) {
  return table([
    { name: 'Readings', align: 'left', cell: (row) => row.when },
    { name: 'Campaign', align: 'left', cell: (row) => row.campaign },
    { name: 'Active compensations', align: 'left', cell: (row) => stated(row.active) },
    { name: 'Number', cell: (row) => count(row.count) },
    { name: 'RMS', cell: (row) => significant(row.rms, 3) },
    { name: 'Largest', cell: (row) => significant(row.max, 3) },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
  ], measuredRows(rows), { className: 'wrapped' });
}

const rangeOf = (row, value) => (row.visible ? fixed(value, 2) : 'not visible');

const errorTable = (rows, caption) => table([
  { name: 'Error', align: 'left', cell: (row) => symbolMark(row.symbol, row.symbol.at(-1)) },
  { name: 'From', cell: (row) => rangeOf(row, row.low) },
  { name: 'To', cell: (row) => rangeOf(row, row.high) },
  { name: 'U95 at most', cell: (row) => fixed(row.U95, 2) },
  { name: 'Unit', align: 'left', cell: (row) => row.unit },
], rows, { caption });

function errorTables(errors) {
  const half = Math.ceil(errors.length / 2);
  return el('div', { class: 'columns' }, [errors.slice(0, half), errors.slice(half)]
    .filter((rows) => rows.length > 0)
    .map((rows) => errorTable(rows, `Errors as identified, ${rows[0].symbol} to ${rows.at(-1).symbol}`)));
}

export function renderCertificateFigures(body, data) {
  body.append(
    el('h3', {}, 'In the volume, computed'),
    table(data.poses > 0 ? [...leftColumns, ...axisColumns] : leftColumns, data.volume),
    note(`Position of the functional point, actual minus nominal without its best rigid motion, at ${data.places} places of the volume, each approached from both sides of every axis`,
      data.poses > 0 ? `; with all axes at ${data.poses} poses over their travel, there with the direction of the tool's axis after the same rigid motion.` : '.'),
  );
  if (data.parts.length > 0) {
    body.append(el('h3', {}, 'By type of compensation'), table([
      { name: 'Type', align: 'left', cell: (row) => row.type },
      { name: 'RMS before', unit: 'µm', cell: (row) => micrometres(row.before) },
      { name: 'RMS after', unit: 'µm', cell: (row) => micrometres(row.after) },
      { name: 'Largest after', unit: 'µm', cell: (row) => micrometres(row.max_after) },
    ], data.parts));
  }
  if (data.rotary.length > 0) {
    body.append(el('h3', {}, 'Rotary axes'), table([...leftColumns,
      axisColumns[0]], data.rotary));
  }
  body.append(
    el('h3', {}, 'Measured'),
    measuredTable(data.measured),
    note('Deviations of the readings from the machine without errors, after the best positions of stations, dead paths and the like.',
      data.measured.length === 1 ? ' Nothing was measured with the tables active.' : ''),
    el('h3', {}, 'Errors as identified, before'),
    errorTables(data.errors),
  );
}

const said = (row) => {
  if (row.recorded === '' && row.known === '') return missing();
  return [row.recorded, row.recorded && row.known ? el('br') : null, row.known ? el('span', { class: row.recorded ? 'muted' : null }, minus(row.known)) : null];
};

export function renderCertificateRecord(body, data) {
  body.append(
    el('table', { class: 'facts record' }, el('tbody', {}, data.rows.map((row) =>
      el('tr', {}, [el('th', { scope: 'row' }, row.item), el('td', {}, said(row))])))),
    note('Grey below a statement: what the readings themselves have recorded.'),
  );
}

export function renderCertificateFiles(body, data) {
  body.append(
    table([
      { name: 'File', align: 'left', cell: (row) => row.name },
      { name: 'Bytes', cell: (row) => count(row.bytes) },
      { name: 'Checksum', cell: (row) => String(row.checksum) },
    ], data.files),
    note('Checksum as ', el('code', {}, 'cksum FILE'), ' prints it (POSIX).'),
  );
}

const field = (label, value = '') => el('div', { class: 'field' }, [el('div', { class: 'written' }, value), el('div', { class: 'muted' }, label)]);

const signer = (title, name) => el('div', { class: 'signer' }, [
  el('h3', {}, title), field('Name', name), field('Place and date'), field('Signature'),
]);

export function renderSignature(body, data) {
  body.append(
    el('p', {}, data.measured_after
      ? 'The machine was measured as recorded above, the tables were computed from these readings, and it was measured again with the tables active.'
      : 'The machine was measured as recorded above and the tables were computed from these readings. Figures with the tables are computed, not measured.'),
    el('div', { class: 'columns signatures' }, [signer('Measured and computed by', data.operator), signer('Accepted by', '')]),
  );
}
