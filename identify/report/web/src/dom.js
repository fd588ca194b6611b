// Small helpers: elements, number formats, tables, buttons.

/** Element with attributes and children (nodes or text; null is skipped). */
export function el(tag, attributes = {}, children = []) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) node.addEventListener(name.slice(2), value);
    else node.setAttribute(name, value === true ? '' : value);
  }
  const list = Array.isArray(children) ? children : [children];
  node.append(...list.flat().filter((child) => child !== null && child !== undefined));
  return node;
}

const minus = (text) => text.replaceAll('-', '−');

/** Number with fixed decimals and a true minus sign; an en dash when there is none. */
export function fixed(value, decimals) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const text = value.toFixed(decimals);
  return minus(Number(text) === 0 ? text.replace('-', '') : text);
}

/** Number with about `digits` significant digits, without exponent where a reader would not expect one. */
export function significant(value, digits = 3) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -5 || size > 7) return minus(value.toExponential(digits - 1));
  return fixed(value, Math.max(0, digits - 1 - size));
}

/** Decimals that show an uncertainty with two significant digits. */
export function decimalsFor(u) {
  if (!Number.isFinite(u) || u <= 0) return 2;
  return Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(u))));
}

export const count = (value) => value.toLocaleString('en-US');

/** Header cell: name, unit below it in a lighter shade. */
function headerCell(column) {
  if (column.name === '') return el('td', {});
  return el('th', { class: column.align ?? 'right', scope: 'col', title: column.title }, [
    column.name,
    column.unit ? el('span', { class: 'unit' }, column.unit) : null,
  ]);
}

const kWords = 16; // characters: longer texts break into lines

const classOf = (column, content) =>
  `${column.align ?? 'right'}${column.align === 'left' && typeof content === 'string' && content.length > kWords ? ' words' : ''}`;

function bodyCell(column, row, isHead) {
  const content = column.cell(row);
  return el(isHead ? 'th' : 'td', { class: classOf(column, content), scope: isHead ? 'row' : null }, content);
}

/**
 * Table from rows of data. Columns: { name, unit, align: 'left' | 'right' (default), cell: row => text or node,
 * title }; the first heads its row. `rowClass`: row => class or null. Without `caption` a table is named after its heading.
 */
export function table(columns, rows, { rowClass = () => null, className = '', caption = null } = {}) {
  const body = rows.map((row) =>
    el('tr', { class: rowClass(row) }, columns.map((column, k) => bodyCell(column, row, k === 0))));
  return el('div', { class: 'table-frame' }, el('table', { class: className }, [
    caption ? el('caption', { class: 'hidden' }, caption) : null,
    el('thead', {}, el('tr', {}, columns.map(headerCell))),
    el('tbody', {}, body),
  ]));
}

const kRowsOnPaper = 20; // as in report.css

/** Table that scrolls on the screen when it is long; on paper its first rows and those that are marked. */
export function longTable(columns, rows, options = {}) {
  const node = table(columns, rows, options);
  if (rows.length <= kRowsOnPaper + 4) return node;
  node.classList.add('long');
  const marked = rows.slice(kRowsOnPaper).filter((row) => options.rowClass?.(row) === 'marked').length;
  const kept = marked > 0 ? ` and ${count(marked)} more that ${marked === 1 ? 'is' : 'are'} marked` : '';
  return el('div', {}, [node, el('p', { class: 'note paper-only' }, `The first ${kRowsOnPaper} of ${count(rows.length)} rows${kept}; the others are on the screen.`)]);
}

/** Row of buttons of which one is chosen. */
export function choice(label, options, onChoose) {
  const buttons = options.map(([value, text]) =>
    el('button', {
      type: 'button',
      onclick: () => {
        select(value);
        onChoose(value);
      },
      'data-value': value,
    }, text));
  const select = (value) => {
    for (const button of buttons) button.setAttribute('aria-pressed', String(button.dataset.value === String(value)));
  };
  select(options[0][0]);
  return el('div', { class: 'choice', role: 'group', 'aria-label': label }, [el('span', { class: 'muted' }, label), ...buttons]);
}

export const note = (...content) => el('p', { class: 'note' }, content);

/** Error symbol in the colour of its axis. */
export const symbolMark = (symbol, axis) => el('span', { class: `symbol axis-${axis}` }, symbol);

/** Horizontal bar for a share between 0 and 1. */
export function bar(share, axis) {
  const width = `${Math.max(0, Math.min(1, share ?? 0)) * 100}%`;
  return el('span', { class: 'bar' }, el('span', { class: `fill axis-${axis}`, style: `width:${width}` }));
}
