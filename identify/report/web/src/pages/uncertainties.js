import { choice, count, el, fixed, longTable, note, significant } from '../dom.js';
import { addPlot, layout2d, legendAbove } from '../plot.js';
import { color, series, transparent } from '../theme.js';
import { printed } from '../words.js';

const approach = { '0': '', '1': ', towards +', '-1': ', towards −' };

function functionPlot(one, data) {
  const scatter = 2 * Math.sqrt(0.5 / data.draws);
  const traces = one.curves.flatMap((curve, k) => {
    const where = approach[curve.direction];
    const hover = (name) => `${name}${where}: %{y:.4g} ${one.unit}<br>%{x} ${one.position_unit}<extra></extra>`;
    const band = [...curve.linear.map((u) => u * (1 + scatter)), ...curve.linear.map((u) => u * (1 - scatter)).reverse()];
    return [
      { x: [...curve.q, ...[...curve.q].reverse()], y: band, type: 'scatter', mode: 'lines', fill: 'toself', fillcolor: transparent(color('muted'), 0.2), line: { width: 0 }, hoverinfo: 'skip', name: 'two standard errors of so many draws', showlegend: k === 0 },
      { x: curve.q, y: curve.linear, type: 'scatter', mode: 'lines', name: `u, linear propagation${where}`, line: { color: color('text'), width: 1.4 }, hovertemplate: hover('linear') },
      { x: curve.q, y: curve.u, type: 'scatter', mode: 'markers', name: `u, Monte Carlo${where}`, marker: { size: 6, color: series(k) }, hovertemplate: hover('Monte Carlo') },
      { x: curve.q, y: curve.bias, type: 'scatter', mode: 'lines', name: `bias${where}`, line: { color: color('bad'), width: 1.2, dash: 'dot' }, hovertemplate: hover('bias') },
    ];
  });
  return {
    data: traces,
    layout: layout2d({ height: 380, margin: { t: 40 }, ...legendAbove(), hovermode: 'closest',
      x: { title: `${one.axis} [${one.position_unit}]`, zeroline: false }, y: { title: `${one.symbol} [${one.unit}]`, rangemode: 'tozero' } }),
  };
}

function summaryText(data) {
  const { validated, undecided, not_validated } = data.verdicts;
  const checked = data.refits > 0 ? ` On ${data.refits} draws that were refitted as well, the largest difference is ${significant(data.linear_share, 2)} of the numerical tolerance for the linear and ${significant(data.chord_share, 2)} for the chord path.` : '';
  const lost = data.not_converged > 0 ? ` ${count(data.not_converged)} draws did not converge.` : '';
  return `${count(data.draws)} draws, seed ${data.seed}, path ${data.path}.${checked}${lost} Linear propagation (GUM Supplement 1, clause 8, ${data.digits} digits): ${count(validated)} values validated, ${count(undecided)} undecided by so few draws, ${count(not_validated)} not validated.`;
}

const kVerdicts = ['not validated', 'undecided', 'validated'];

/** On paper a long table ends before its rows do. */
const worstFirst = (rows) => [...rows].sort((a, b) => kVerdicts.indexOf(a.verdict) - kVerdicts.indexOf(b.verdict));

export function renderUncertainties(body, data) {
  body.append(note(summaryText(data)));
  if (data.held !== '') body.append(el('p', { class: 'note strong' }, `Of the steps: ${data.held}.`));
  if (data.messages.length > 0) body.append(el('ul', { class: 'messages' }, data.messages.map((text) => el('li', {}, printed(text)))));
  for (const words of data.disturbances) body.append(note(`Disturbed by ${words}, which the fit knows nothing of.`));
  if (data.functions.length > 0) {
    let shown = data.functions[0];
    const node = el('div', { class: 'plot' });
    const redraw = addPlot(node, () => functionPlot(shown, data));
    const menu = choice('Error', data.functions.map((one, k) => [String(k), one.symbol]), (k) => { shown = data.functions[Number(k)]; redraw(); });
    body.append(el('div', { class: 'controls' }, [menu]), node);
  }
  body.append(longTable([
    { name: 'Quantity', align: 'left', cell: (row) => row.name },
    { name: 'u linear', cell: (row) => significant(row.linear, 3) },
    { name: 'u', cell: (row) => significant(row.u, 3) },
    { name: 'u / u linear', cell: (row) => (row.linear > 0 && row.u !== null ? fixed(row.u / row.linear, 3) : '–') },
    { name: 'Bias', cell: (row) => significant(row.bias, 2) },
    { name: '±', cell: (row) => significant(row.bias_error, 1) },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
    { name: 'Linear propagation', align: 'left', cell: (row) => row.verdict },
  ], worstFirst(data.others)));
}
