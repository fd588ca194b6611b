import { bar, el, fixed, longTable, note, significant, table } from '../dom.js';
import { addPlot, layout2d, plain } from '../plot.js';
import { color } from '../theme.js';
import { printed } from '../words.js';

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

const lawColumns = [
  { name: 'Law', align: 'left', cell: (law) => law.label },
  { name: 'Shape', align: 'left', cell: (law) => law.shape },
  { name: 'Amplitude', cell: (law) => significant(law.amplitude) },
  { name: '± U95', cell: (law) => significant(law.U95, 2) },
  { name: 'Unit', align: 'left', cell: (law) => law.unit },
  { name: 'Gain', cell: (law) => fixed(law.gain, 1) },
  { name: 'log10 p', cell: (law) => fixed(law.log10_p, 1) },
  { name: 'Log evidence', cell: (law) => fixed(law.log_evidence, 1) },
];

/** Large ratios stay on the page, small ones stay apart: asinh is linear about zero and logarithmic far out. */
const place = Math.asinh;
const kTicks = [0, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];

/** The amplitude that stands out most of an effect that has several. */
function leading(effect) {
  const usable = effect.amplitudes.filter((amplitude) => amplitude.mdb > 0 && amplitude.value !== null && amplitude.U95 !== null);
  const ratio = (amplitude) => Math.abs(amplitude.value) / amplitude.mdb;
  return usable.reduce((best, amplitude) => (best === null || ratio(amplitude) > ratio(best) ? amplitude : best), null);
}

function chance({ log10_p: log }) {
  return log > -2.5 ? `p ${significant(10 ** log, 1)}` : printed(`p 10^${Math.round(log)}`);
}

/** Amplitudes ± U95 over the smallest that would be found, strongest evidence on top; p as text. */
function evidencePlot(data, effects) {
  const shown = effects.map((effect) => ({ effect, amplitude: leading(effect) })).filter(({ amplitude }) => amplitude).slice(0, 20).reverse();
  const y = shown.map((_, k) => k);
  const [added, alternatives] = [data.added, data.alternatives.flat()].map((list) => new Set(list.map((effect) => effect.label)));
  const shadeOf = (effect) => (added.has(effect.label) ? color('good') : alternatives.has(effect.label) ? color('warning') : effect.log10_p < data.threshold ? color('bad') : color('muted'));
  const parts = shown.map(({ effect, amplitude }) => ({ effect, amplitude, at: Math.abs(amplitude.value) / amplitude.mdb, half: amplitude.U95 / amplitude.mdb, shade: shadeOf(effect) }));
  const far = Math.max(1.3, ...parts.map(({ at, half }) => at + half));
  const near = Math.min(0, ...parts.map(({ at, half }) => at - half));
  const line = (part, k) => ({ type: 'line', x0: place(part.at - part.half), x1: place(part.at + part.half), y0: k, y1: k, line: { color: part.shade, width: 2.4 } });
  return {
    data: [{
      x: parts.map(({ at }) => place(at)), y, type: 'scatter', mode: 'markers', marker: { size: 9, color: parts.map(({ shade }) => shade) },
      text: parts.map(({ effect, amplitude, at }) => `${plain(effect.label)} (${effect.kind})<br>${plain(amplitude.label)} ${significant(amplitude.value)} ± ${significant(amplitude.U95, 2)} ${plain(amplitude.unit)}, ${significant(at, 2)} times the smallest that would be found<br>log10 p ${fixed(effect.log10_p, 1)}, visible fraction ${fixed(effect.visible_fraction, 2)}`),
      hovertemplate: '%{text}<extra></extra>',
    }],
    paperHeight: 0.85,
    layout: layout2d({
      height: 92 + 21 * shown.length, margin: { l: 10, r: 62, t: 26 }, hovermode: 'closest',
      x: { title: '|amplitude| ± U95, over the smallest that would be found (MDB)', range: [place(near) - 0.05, place(far) + 0.15], zeroline: true, tickvals: kTicks.map(place), ticktext: kTicks.map(String) },
      y: { title: '', tickvals: y, ticktext: parts.map(({ effect }) => plain(effect.label)), showgrid: false, zeroline: false, range: [-0.7, shown.length - 0.3] },
      shapes: [
        ...parts.map(line),
        { type: 'line', x0: place(1), x1: place(1), yref: 'paper', y0: 0, y1: 1, line: { color: color('bad'), width: 1.2, dash: 'dash' } },
      ],
      annotations: [
        { x: place(1), yref: 'paper', y: 1, yanchor: 'bottom', xanchor: 'left', showarrow: false, text: 'found in four campaigns of five', font: { size: 11, color: color('bad') } },
        ...parts.map(({ effect }, k) => ({ xref: 'paper', x: 1, xanchor: 'left', xshift: 6, y: k, showarrow: false, text: chance(effect), font: { size: 11, color: color('muted') } })),
      ],
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
  body.append(note(`Score test of each of ${data.families} effects, after projection off everything the model can already do. p counts all effects tested; below 0.5 % an effect is above the noise. Drawn: the amplitude it would have if it were added, with its 95 % interval, in units of the smallest amplitude that these readings would show; the strongest of so many leave zero by chance alone, which p counts. Visible fraction: share of its signal that no parameter of the model imitates. MDB: smallest amplitude that is found with 80 % power; MIB: smallest that is also separated from every other effect, the worst of which is the rival.`));
  const node = el('div', { class: 'plot' });
  body.append(el('figure', {}, [el('figcaption', {}, caption(data)), node]));
  addPlot(node, () => evidencePlot(data, [...first, ...others]));
  if (data.added.length > 0) body.append(el('h3', {}, 'Added'), table(columns, rows(data.added)));
  for (const set of data.alternatives) body.append(el('h3', {}, 'The readings cannot separate'), table(columns, rows(set)));
  if (data.own.length > 0) body.append(el('h3', {}, 'Your own'), table(columns, rows(data.own)));
  for (const asked of data.laws) {
    const enough = `${asked.sufficient} explain${asked.sufficient === 1 ? 's' : ''} as much as the ${asked.label}, whose log evidence is ${fixed(asked.surface_evidence, 1)}`;
    body.append(el('h3', {}, `Laws of the ${asked.label}`), note(`${asked.tried} products of elementary functions were tried, which p and the evidence count; of the best ${enough}.`), table(lawColumns, asked.rows));
  }
  body.append(el('h3', {}, 'Not added, strongest first'), longTable(columns, rows(others)));
}
