import { bar, el, fixed, note, significant, symbolMark, table } from '../dom.js';
import { caption } from '../names.js';
import { color, onThemeChange, shaded } from '../theme.js';

function errorBars(errors) {
  const largest = {};
  for (const error of errors) {
    if (error.visible) largest[error.unit] = Math.max(largest[error.unit] ?? 0, error.u_rms);
  }
  return table([
    { name: 'Error', align: 'left', cell: (row) => symbolMark(row.symbol, row.axis) },
    { name: 'Visible fraction', align: 'left', cell: (row) => bar(row.visible_fraction, row.axis) },
    { name: '', cell: (row) => fixed(row.visible_fraction, 3) },
    { name: 'u (RMS over the travel)', align: 'left', cell: (row) => (row.visible ? bar(row.u_rms / largest[row.unit], row.axis) : '') },
    { name: '', cell: (row) => (row.visible ? significant(row.u_rms, 2) : '–') },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
    { name: 'Effective parameters', cell: (row) => fixed(row.effective_parameters, 1) },
    { name: '', align: 'left', cell: (row) => (row.visible ? '' : 'not visible') },
  ], errors, { rowClass: (row) => (row.visible ? null : 'dim'), className: 'bars' });
}

/** The stronger the shade of a cell, the more collinear the two errors are. */
const shadeOf = (value) => shaded(color('heat'), Math.round(value * value * 100) / 100);

function heatCell(correlation, a, b) {
  if (a === b) return el('td', { class: 'own' });
  const value = correlation.value[a][b];
  const title = `${correlation.symbol[a]} and ${correlation.symbol[b]}: ${fixed(value, 3)}`;
  return el('td', { title, style: shadeOf(value) }, value >= 0.3 ? fixed(value, 2).slice(1) : '');
}

function heatMap(correlation) {
  const { symbol } = correlation;
  return el('div', { class: 'table-frame' }, el('table', { class: 'heat' }, [
    caption('Correlation between errors'),
    el('thead', {}, el('tr', {}, [el('td'), ...symbol.map((name) => el('th', { scope: 'col', class: `axis-${name.at(-1)}` }, el('span', {}, name)))])),
    el('tbody', {}, symbol.map((name, a) => el('tr', {}, [
      el('th', { scope: 'row', class: `axis-${name.at(-1)}` }, name),
      ...symbol.map((other, b) => heatCell(correlation, a, b)),
    ]))),
  ]));
}

export function renderObservability(body, data) {
  const map = el('div', {}, heatMap(data.correlation));
  onThemeChange(() => map.replaceChildren(heatMap(data.correlation)));
  body.append(el('p', {}, data.rank_text));
  if (data.invisible.length > 0) {
    body.append(el('ul', { class: 'messages' }, data.invisible.map((text) => el('li', {}, text))));
  }
  body.append(
    errorBars(data.errors),
    note('Visible fraction: share of the error’s signal in the readings that no other parameter can imitate; 1 is ideal, 0 is invisible. Bars of u are relative to the largest of the same unit.'),
    el('h3', {}, 'Correlation between errors'),
    map,
    note('0 … 1: square root of the RV coefficient of the two functions’ covariances, sampled along the travel; |correlation| for squareness. Values of 0.30 and more are printed. Strong correlation: the sum or the difference of the two is known much better than each.'),
  );
}
