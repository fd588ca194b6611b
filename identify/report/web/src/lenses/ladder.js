// A ladder of models: the systematic error on held-out lines after every step.
import { significant } from '../dom.js';
import { layout2d, plain } from '../plot.js';
import { color, series, transparent } from '../theme.js';

export const stepName = (step) => (step.added === '' ? 'as given' : `+ ${step.added}`);

/** Names of the steps under the plot, broken where they are long. */
// Under a bar an error of the machine stands by its symbol: "+ EXX".
const shortName = (step) => stepName(step).replace(/, (error motion|location error|squareness) of .*/, '');

export const stepAxis = (ladder) => ({
  title: 'model', tickvals: ladder.map((_, k) => k), ticktext: ladder.map((step) => broken(shortName(step))), zeroline: false, showgrid: false, range: [-0.6, Math.max(0.6, ladder.length - 0.4)],
});

function broken(text) {
  const lines = [''];
  for (const word of text.split(' ')) {
    if (lines.at(-1).length + word.length > 16 && lines.at(-1) !== '') lines.push('');
    lines[lines.length - 1] += (lines.at(-1) === '' ? '' : ' ') + word;
  }
  return lines.map(plain).join('<br>');
}

/** Systematic error above the noise floor after every step, with its interval, and what each step took away. */
export function waterfall(ladder) {
  const x = ladder.map((_, k) => k);
  const high = ladder.map((step) => step.systematic_high_um - step.systematic_um);
  const low = ladder.map((step) => step.systematic_um - step.systematic_low_um);
  const connectors = ladder.slice(1).map((step, k) => ({
    type: 'line', x0: k, x1: k + 1, y0: ladder[k].systematic_um, y1: ladder[k].systematic_um, line: { color: color('muted'), width: 1, dash: 'dot' },
  }));
  const drops = ladder.slice(1).map((step, k) => [k + 1, ladder[k].systematic_um, ladder[k].systematic_um - step.systematic_um])
    .filter(([, , drop]) => drop > 0)
    .map(([x1, y, drop]) => ({ x: x1 + 0.26, y, xanchor: 'left', yanchor: 'top', showarrow: false, font: { size: 11, color: color('good') }, text: `−${significant(drop, 2)} µm` }));
  const top = 1.15 * Math.max(...ladder.map((step) => step.systematic_high_um));
  const bars = [
    ...ladder.slice(1).map((step, k) => ({ at: k + 1, from: step.systematic_um, to: Math.max(step.systematic_um, ladder[k].systematic_um), fill: transparent(color('good'), 0.15) })),
    ...ladder.map((step, k) => ({ at: k, from: 0, to: step.systematic_um, fill: series(0) })),
  ].map(({ at, from, to, fill }) => ({ type: 'rect', x0: at - 0.25, x1: at + 0.25, y0: from, y1: to, fillcolor: fill, line: { width: 0 }, layer: 'between' }));
  return {
    data: [{
      x, y: ladder.map((step) => step.systematic_um), type: 'scatter', mode: 'markers', marker: { size: 7, color: color('text') },
      error_y: { type: 'data', symmetric: false, array: high, arrayminus: low, color: color('text'), thickness: 1.4, width: 6 },
      text: ladder.map((step) => `${plain(stepName(step))}<br>systematic ${significant(step.systematic_um)} µm, 95 %: ${significant(step.systematic_low_um, 2)} … ${significant(step.systematic_high_um, 2)} µm`),
      hovertemplate: '%{text}<extra></extra>',
    }],
    layout: layout2d({
      height: 330, margin: { r: 52 }, x: stepAxis(ladder), y: { title: 'systematic error on held-out lines [µm]', range: [0, top > 0 ? top : 1] },
      shapes: [...bars, ...connectors], annotations: drops, hovermode: 'closest',
    }),
  };
}
