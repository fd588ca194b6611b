import { decimalsFor, el, fixed, longTable, note, significant, table } from '../dom.js';
import { addPlot, layout2d, legendAbove, plain } from '../plot.js';
import { stepAxis, stepName, waterfall } from '../lenses/ladder.js';
import { renderSurface } from '../lenses/surface.js';
import { color, series, transparent } from '../theme.js';
import { printed } from '../words.js';

/** RMS of held-out and fitted readings against the noise floor. */
function rmsPlot(ladder) {
  const x = ladder.map((_, k) => k);
  const line = (key, name, shade, symbol) => ({
    x, y: ladder.map((step) => step[key]), type: 'scatter', mode: 'lines+markers', name, line: { color: shade, width: 1.6 }, marker: { size: 8, symbol, color: shade },
    text: ladder.map((step) => plain(stepName(step))), hovertemplate: `%{text}<br>${name} %{y:.4g} µm<extra></extra>`,
  });
  const floor = { ...line('noise_floor_um', 'noise floor', color('muted'), 'line-ew-open'), fill: 'tozeroy', fillcolor: transparent(color('muted'), 0.15) };
  const all = ladder.flatMap((step) => [step.rms_heldout_um, step.rms_fit_um, step.noise_floor_um]);
  return {
    data: [floor, line('rms_heldout_um', 'held-out lines', color('bad'), 'circle'), line('rms_fit_um', 'fitted readings', series(0), 'square')],
    layout: layout2d({
      height: 330, ...legendAbove(), margin: { t: 34 },
      x: stepAxis(ladder),
      y: { title: 'RMS of the residuals [µm]', range: [0.85 * Math.min(...all), 1.05 * Math.max(...all)] },
    }),
  };
}

/** What distinguishes one of several amplitudes of an effect: "x", "cos". */
const partOf = (effect, amplitude) => (effect.amplitudes.length > 1 ? `${amplitude.label.replace(effect.label, '').trim()} ` : '');

const amplitudeText = (effect, amplitude) => `${partOf(effect, amplitude)}${fixed(amplitude.value, decimalsFor(amplitude.U95))} ± ${significant(amplitude.U95, 2)} ${amplitude.unit}`;

const missingItem = (effect) => el('div', { class: 'found' }, [
  el('strong', {}, effect.resolution ? `${effect.label}: the function needs more knots` : effect.label),
  effect.amplitudes.length > 0 ? el('span', { class: 'amount' }, effect.amplitudes.map((amplitude) => amplitudeText(effect, amplitude)).join('; ')) : null,
  effect.plain ? el('p', { class: 'plain' }, effect.plain) : null,
  effect.usual_causes ? el('p', { class: 'plain' }, [el('strong', {}, 'Usual causes: '), `${effect.usual_causes}.`]) : null,
  el('div', { class: 'muted' }, `${effect.kind}, ${effect.shape} in ${effect.driver}; ${printed(effect.how)}.`),
]);

const drawnItem = (surface) => el('div', { class: 'found' }, [
  el('strong', {}, surface.label),
  el('div', { class: 'muted' }, `no effect of the catalogue explains it as well as a smooth function does; log evidence over the model without it +${fixed(surface.log_evidence, 0)}.`),
]);

const ladderTable = (ladder) => table([
  { name: 'Model', align: 'left', cell: (row) => row.model },
  { name: 'Added', align: 'left', cell: (row) => (row.added === '' ? 'as given' : row.added) },
  { name: 'RMS fitted', unit: 'µm', cell: (row) => significant(row.rms_fit_um, 4) },
  { name: 'RMS held out', unit: 'µm', cell: (row) => significant(row.rms_heldout_um, 4) },
  { name: 'Noise floor', unit: 'µm', cell: (row) => significant(row.noise_floor_um, 4) },
  { name: 'Systematic', unit: 'µm', cell: (row) => significant(row.systematic_um) },
  { name: '95 % interval', unit: 'µm', cell: (row) => (row.systematic_low_um === null ? '–' : `${significant(row.systematic_low_um)} … ${significant(row.systematic_high_um)}`) },
  { name: 'χ²/dof', cell: (row) => fixed(row.reduced_chi2, 3) },
  { name: 'Log-likelihood gain', unit: 'held out', cell: (row) => fixed(row.heldout_loglik_gain, 1) },
], ladder);

const belowTable = (groups) => longTable([
  { name: 'Kind', align: 'left', cell: (row) => row.kind },
  { name: 'Effects', cell: (row) => row.effects },
  { name: 'Not visible', cell: (row) => row.not_visible },
  { name: 'Smallest MDB', cell: (row) => significant(row.smallest, 2) },
  { name: 'Largest MDB', cell: (row) => significant(row.largest, 2) },
  { name: 'Unit', align: 'left', cell: (row) => row.unit },
  { name: 'Found first', align: 'left', cell: (row) => row.smallest_label ?? '–' },
  { name: 'Found last', align: 'left', cell: (row) => row.largest_label ?? '–' },
], groups);

export function renderStory(body, data) {
  body.append(el('div', { class: `status ${data.level}`, 'data-verdict': data.verdict }, [
    el('strong', {}, data.headline), ...data.words.map((text) => el('p', {}, printed(text))),
  ]));
  for (const surface of data.surfaces) renderSurface(body, surface);
  body.append(el('h3', {}, 'Before'), ...data.before.map((text) => el('p', {}, text)));
  body.append(el('h3', {}, 'What was missing, and how we know'));
  body.append(...data.surfaces.map(drawnItem), ...data.missing.map(missingItem));
  if (data.missing.length === 0 && data.one_of.length === 0 && data.surfaces.length === 0) {
    body.append(el('p', {}, `Nothing was added: none of the ${data.families} effects tested is above the noise and separated from the others.`));
  }
  for (const set of data.one_of) {
    body.append(el('p', {}, 'One of the following is missing; these readings do not tell them apart:'), ...set.map((effect) => missingItem({ ...effect, how: `log10 p ${fixed(effect.log10_p, 1)}` })));
  }
  body.append(el('h3', {}, 'After'), ...data.after.map((text) => el('p', {}, printed(text))));
  const whole = data.ladder.filter((step) => step.rms_heldout_um !== null);
  if (whole.length > 1) {
    const plots = [el('div', { class: 'plot' }), el('div', { class: 'plot' })];
    body.append(el('div', { class: 'pair' }, [
      el('figure', {}, [el('figcaption', {}, 'What is above the noise floor, step by step'), plots[0]]),
      el('figure', {}, [el('figcaption', {}, 'RMS of the residuals, noise included'), plots[1]]),
    ]));
    addPlot(plots[0], () => waterfall(whole));
    addPlot(plots[1], () => rmsPlot(whole));
  }
  body.append(
    ladderTable(data.ladder),
    note('Held-out lines chose nothing: every tenth line of each setup. Noise floor: what the noise model and the uncertainty of the parameters make of these lines. Systematic: √(mean square − floor²), with 95 % interval.'),
  );
  if (data.next_measurement.length > 0) {
    body.append(el('h3', {}, 'What to measure next'), el('ul', {}, data.next_measurement.map((text) => el('li', {}, text))));
  }
  body.append(
    el('h3', {}, 'What is still below the detection limit'),
    note('MDB, the smallest detectable amplitude: an effect of this size is found in four campaigns of five. Anything smaller may be there. Every effect is in the table “Smallest detectable effects”.'),
    belowTable(data.below),
  );
}
