import { count, el, fixed, note, significant, table } from '../dom.js';
import { addPlot, layout2d, legendAbove, plain } from '../plot.js';
import { color, series } from '../theme.js';

const kLineHeight = 17;
const kBarWidth = 11;

/** Bars as thick lines, one trace a source; the point in the middle of each piece is what one hovers over. */
function stackedBars(data) {
  const groups = [...data.groups].reverse();
  const others = (group) => Math.max(0, 1 - group.share.reduce((sum, share) => sum + share, 0));
  const sources = data.sources.map((name, k) => ({ name: plain(name), share: (group) => group.share[k], shade: series(k) }));
  if (data.others > 0) sources.push({ name: `${data.others} others`, share: others, shade: color('muted') });
  const begin = groups.map(() => 0);
  const traces = sources.map(({ name, share, shade }) => {
    const trace = { type: 'scatter', mode: 'lines', name, x: [], y: [], customdata: [], line: { color: shade, width: kBarWidth },
      hovertemplate: `%{y}: %{customdata[0]} % of the variance<br>%{customdata[1]} of %{customdata[2]}<extra>${name}</extra>` };
    groups.forEach((group, i) => {
      const end = begin[i] + share(group);
      const u = group.u * Math.sqrt(Math.max(0, share(group)));
      const shown = [fixed(100 * share(group), 1), `${significant(u, 3)} ${group.unit}`, `${significant(group.u, 3)} ${group.unit}`];
      trace.x.push(100 * begin[i], 50 * (begin[i] + end), 100 * end, null);
      trace.y.push(...Array(4).fill(plain(group.name)));
      trace.customdata.push(shown, shown, shown, shown);
      begin[i] = end;
    });
    return trace;
  });
  return {
    data: traces,
    paperHeight: 0.85,
    layout: layout2d({
      height: 110 + kLineHeight * groups.length, margin: { t: 60 }, hovermode: 'closest', ...legendAbove(),
      x: { title: 'share of the variance [%]', range: [0, 100], zeroline: false },
      y: { title: '', tickfont: { size: 10 }, showgrid: false, range: [-0.7, groups.length - 0.3] },
    }),
  };
}

export function renderBudget(body, data) {
  body.append(note('By linear propagation, mean over the values of each line. Sources are independent: the squares of their contributions add up to u². “Roughness” is what smoothing assumes of the error functions between and beside the readings.'));
  const node = el('div', { class: 'plot' });
  body.append(node);
  addPlot(node, () => stackedBars(data));
  if (data.halved.length === 0) return;
  body.append(
    el('h3', {}, 'If one source were half as large'),
    table([
      { name: 'Source', align: 'left', cell: (row) => row.source },
      { name: 'u in the volume', unit: 'µm RMS', cell: (row) => fixed(row.u_um, 4) },
      { name: 'Less by', unit: '%', cell: (row) => fixed(100 * row.less, 1) },
    ], data.halved),
    note(`Now ${significant(data.volume_u_um, 3)} µm: root mean square of u of ex, ey and ez over the volume and all tools. Readings are weighted as they are; with new weights a better instrument brings a little more. ${count(data.others)} other sources contribute less than 1 % everywhere.`),
  );
}
