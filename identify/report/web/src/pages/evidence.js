import { bar, el, fixed, longTable, note, significant, table } from '../dom.js';
import { addPlot, layout2d, plain } from '../plot.js';
import { color, series, transparent } from '../theme.js';

const rows = (effects) => effects.flatMap((effect) => (effect.amplitudes.length === 0
  ? [{ effect, amplitude: null, first: true }]
  : effect.amplitudes.map((amplitude, k) => ({ effect, amplitude, first: k === 0 }))));

const columns = [
  { name: 'Effect', align: 'left', cell: (row) => (row.amplitude ? row.amplitude.label : row.effect.label) },
  { name: 'Kind', align: 'left', cell: (row) => (row.first ? row.effect.kind : '') },
  { name: 'Shape', align: 'left', cell: (row) => (row.first ? row.effect.shape : '') },
  { name: 'Amplitude', cell: (row) => significant(row.amplitude?.value) },
  { name: '± U95', cell: (row) => significant(row.amplitude?.U95, 2) },
  { name: 'MDB', cell: (row) => significant(row.amplitude?.mdb, 2) },
  { name: 'Unit', align: 'left', cell: (row) => row.amplitude?.unit ?? '' },
  { name: 'Visible fraction', align: 'left', cell: (row) => (row.first ? bar(row.effect.visible_fraction, '') : '') },
  { name: '', cell: (row) => (row.first ? fixed(row.effect.visible_fraction, 2) : '') },
  { name: 'log10 p', cell: (row) => (row.first ? fixed(row.effect.log10_p, 1) : '') },
];

/** Bars of −log10 p, strongest on top, with the threshold. The plot library's bundle has no bars of its own. */
function evidencePlot(data, effects) {
  const shown = effects.slice(0, 20).reverse();
  const y = shown.map((_, k) => k);
  const threshold = -data.threshold;
  const [added, alternatives] = [data.added, data.alternatives.flat()].map((list) => new Set(list.map((effect) => effect.label)));
  const most = Math.max(1.3 * threshold, ...shown.map((effect) => -effect.log10_p));
  const shadeOf = (effect) => (added.has(effect.label) ? color('good') : alternatives.has(effect.label) ? color('warning') : effect.log10_p < data.threshold ? color('bad') : series(6));
  return {
    data: [{
      x: shown.map((effect) => -effect.log10_p), y, type: 'scatter', mode: 'markers', marker: { size: 14, color: transparent(color('text'), 0) },
      text: shown.map((effect) => `${plain(effect.label)} (${effect.kind})<br>log10 p ${fixed(effect.log10_p, 1)}, visible fraction ${fixed(effect.visible_fraction, 2)}`),
      hovertemplate: '%{text}<extra></extra>',
    }],
    paperHeight: 0.85,
    layout: layout2d({
      height: 76 + 20 * shown.length, margin: { l: 10, t: 26 }, hovermode: 'closest',
      x: { title: '−log10 p, family-wise', range: [0, 1.05 * most], zeroline: false },
      y: { title: '', tickvals: y, ticktext: shown.map((effect) => plain(effect.label)), showgrid: false, zeroline: false, range: [-0.7, shown.length - 0.3] },
      shapes: [
        ...shown.map((effect, k) => ({ type: 'rect', x0: 0, x1: -effect.log10_p, y0: k - 0.3, y1: k + 0.3, fillcolor: shadeOf(effect), line: { width: 0 }, layer: 'between' })),
        { type: 'line', x0: threshold, x1: threshold, yref: 'paper', y0: 0, y1: 1, line: { color: color('bad'), width: 1.2, dash: 'dash' } },
      ],
      annotations: [{ x: threshold, yref: 'paper', y: 1, yanchor: 'bottom', xanchor: 'left', showarrow: false, text: 'threshold 0.5 %', font: { size: 11, color: color('bad') } }],
    }),
  };
}

/** Effects without those that came before under the same label: one may stand in several sets. */
const unique = (effects) => effects.filter((effect, k) => effects.findIndex((other) => other.label === effect.label) === k);

const caption = (data) => {
  const parts = [data.added.length > 0 ? 'Green: added, with the evidence when it was.' : '', data.alternatives.length > 0 ? 'Orange: alternatives that the readings do not separate.' : ''];
  return parts.some(Boolean) ? [...parts, 'Others: at the model reached.'].filter(Boolean).join(' ') : 'Strongest candidates at the given model';
};

export function renderEvidence(body, data) {
  const first = unique([...data.added, ...data.alternatives.flat()]);
  const known = new Set(first.map((effect) => effect.label));
  const others = data.ranking.filter((effect) => !known.has(effect.label));
  body.append(note(`Score test of each of ${data.families} effects, after projection off everything the model can already do. p counts all effects tested; below the threshold an effect is above the noise. Visible fraction: share of its signal that no parameter of the model imitates. MDB: smallest amplitude that is found with 80 % power; MIB: smallest that is also separated from every other effect, the worst of which is the rival.`));
  const node = el('div', { class: 'plot' });
  body.append(el('figure', {}, [el('figcaption', {}, caption(data)), node]));
  addPlot(node, () => evidencePlot(data, [...first, ...others]));
  if (data.added.length > 0) body.append(el('h3', {}, 'Added'), table(columns, rows(data.added)));
  for (const set of data.alternatives) body.append(el('h3', {}, 'The readings cannot separate'), table(columns, rows(set)));
  body.append(el('h3', {}, 'Not added, strongest first'), longTable(columns, rows(others)));
}
