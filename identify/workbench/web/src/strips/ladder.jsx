// The ladder: a chip for every model, what is left of the error at each, and the pair that is compared.
import { useEffect, useRef, useState } from 'preact/hooks';
import { fixed, significant } from '../../../../report/web/src/dom.js';
import { waterfall } from '../../../../report/web/src/lenses/ladder.js';
import { compareWith, go } from '../app/actions.js';
import { micrometres } from '../app/sentences.js';
import { beforeModel, busy, chosenBefore, currentModel, line, mayAct, modelName, state } from '../app/store.js';
import { treeOf } from '../data/tree.js';
import { Drawing, words } from '../panels/parts.jsx';

const kFall = 600; // ms: numbers run from the old to the new

const quiet = () => matchMedia('(prefers-reduced-motion: reduce)').matches;

/** A number that runs to its new value. */
function Running({ value, show }) {
  const [at, setAt] = useState(value);
  const from = useRef(value);
  useEffect(() => {
    const start = from.current;
    from.current = value;
    if (quiet() || !Number.isFinite(start) || !Number.isFinite(value) || start === value) {
      setAt(value);
      return undefined;
    }
    let frame = 0;
    const begun = performance.now();
    const step = (now) => {
      const t = Math.min(1, Math.max(0, (now - begun) / kFall));
      setAt(start + (value - start) * (1 - (1 - t) ** 3));
      if (t < 1) frame = requestAnimationFrame(step);
    };
    frame = requestAnimationFrame(step);
    return () => cancelAnimationFrame(frame);
  }, [value]);
  return <>{show(at)}</>;
}

const isAwaiting = (standing) => standing === 'preview' || standing === 'refitted';

/** In which state the numbers of a model are. */
function standingOf(model) {
  if (busy.value?.what === 'confirm' && (busy.value.model ?? state.value.current) === model.number && isAwaiting(model.standing)) return model.standing === 'preview' ? 'preview' : 'confirming';
  if (line.value !== 'open') return 'stale';
  return model.standing;
}

const kStandings = {
  preview: 'linear preview: noise and smoothing as before the step', refitted: 'refit: noise and smoothing found again; not yet a full fit',
  confirming: 'refit: noise and smoothing found again; being confirmed by a full fit', fitted: 'confirmed by a full fit',
  contradicted: 'the full fit contradicts what stood before', stale: 'as last heard: the program does not answer',
};
const about = (standing) => (isAwaiting(standing) || standing === 'confirming' ? '~' : '');

function Headline({ model, first, former }) {
  const { figures } = model;
  const standing = standingOf(model);
  const fell = Number.isFinite(first?.figures?.systematic_um) && first.number !== model.number ? 100 * (1 - figures.systematic_um / first.figures.systematic_um) : null;
  const show = (value) => micrometres(value, figures.systematic_low_um, figures.systematic_high_um);
  return (
    <div class={`headline is-${standing}`} data-standing={standing}>
      <div class="figure main"><span class="name">Systematic error on held-out lines</span>
        <span class="value">{about(standing)}<Running value={figures.systematic_um} show={show} /> <span class="unit">µm</span></span>
        <span class="muted">95 %: {show(figures.systematic_low_um)} … {show(figures.systematic_high_um)} µm{fell !== null && Number.isFinite(fell) ? `; ${fell >= 0 ? '−' : '+'}${fixed(Math.abs(fell), 0)} % of as given` : ''}</span></div>
      <div class="figure"><span class="name">RMS of held-out lines</span><span class="value small">{about(standing)}<Running value={figures.rms_heldout_um} show={(v) => significant(v, 4)} /> <span class="unit">µm</span></span><span class="muted">fitted {significant(figures.rms_fit_um, 4)} µm</span></div>
      <div class="figure"><span class="name">Noise floor</span><span class="value small">{significant(figures.noise_floor_um, 3)} <span class="unit">µm</span></span><span class="muted">below it nothing shows</span></div>
      <div class="figure"><span class="name">χ²/dof</span><span class="value small">{about(standing)}<Running value={figures.reduced_chi2} show={(v) => fixed(v, 3)} /></span><span class="muted">{former ? `before ${fixed(former.figures?.reduced_chi2, 3)}` : '1 if the noise model holds'}</span></div>
      <p class="standing">{kStandings[standing] ?? standing}{model.contradiction ? `: ${words(model.contradiction)}` : ''}</p>
    </div>
  );
}

/** Systematic error with its interval and the noise floor, on one scale for all chips. */
function Whisker({ figures, most }) {
  const x = (value) => 2 + 156 * Math.min(1, Math.max(0, (value ?? 0) / most));
  return (
    <svg class="whisker-plot" viewBox="0 0 160 14" width="160" height="14" aria-hidden="true">
      <line class="axis" x1="2" x2="158" y1="12" y2="12" />
      {figures.noise_floor_um > 0 && <rect class="floor" x="2" y="9" width={x(figures.noise_floor_um) - 2} height="3" />}
      <line class="interval" x1={x(figures.systematic_low_um)} x2={x(figures.systematic_high_um)} y1="5" y2="5" />
      <circle class="dot" cx={x(figures.systematic_um)} cy="5" r="3.5" />
    </svg>
  );
}

function Chip({ model, depth, row, parentRow, most }) {
  const { figures } = model;
  const standing = standingOf(model);
  const current = model.number === state.value.current;
  const grey = beforeModel.value?.number === model.number;
  const branched = parentRow !== null && parentRow !== row;
  return (
    <li class={`chip is-${standing} ${current ? 'current' : ''} ${grey ? 'before' : ''} ${branched ? 'branched' : ''}`} style={{ gridColumn: depth + 1, gridRow: row + 1 }} data-model={model.number}>
      <button type="button" class="model" aria-current={current ? 'true' : undefined} disabled={!mayAct.value && !current} onClick={() => !current && go(model.number)} title={kStandings[standing]}>
        <span class="change">{branched && <span aria-label="branch of an earlier model">↳ </span>}{modelName(model)}</span>
        <span class="numbers"><b>{about(standing)}{micrometres(figures.systematic_um, figures.systematic_low_um, figures.systematic_high_um)}</b> µm <span class="muted">{micrometres(figures.systematic_low_um, figures.systematic_low_um, figures.systematic_high_um)} … {micrometres(figures.systematic_high_um, figures.systematic_low_um, figures.systematic_high_um)}</span></span>
        <Whisker figures={figures} most={most} />
        <span class="muted small">χ²/dof {fixed(figures.reduced_chi2, 2)}, floor {significant(figures.noise_floor_um, 2)} µm</span>
      </button>
      {!current && <button type="button" class="compare" aria-pressed={grey} aria-label={`${grey ? 'in grey' : 'compare'}: ${modelName(model)}`} onClick={() => compareWith(grey && chosenBefore.value !== null ? null : model.number)}>{grey ? 'in grey' : 'compare'}</button>}
      {current && <span class="compare here">in colour</span>}
    </li>
  );
}

const makeWaterfall = (models) => () => waterfall(models.map((model) => ({ ...model.figures, added: model.change ?? '' })));

/** From the model as given to the current one. */
function wayTo(models, number) {
  const way = [];
  for (let model = models.find((each) => each.number === number); model; model = models.find((each) => each.number === model.parent)) way.unshift(model);
  return way;
}

export function Ladder() {
  const { models } = state.value;
  const model = currentModel.value;
  const list = useRef();
  const [drawn, setDrawn] = useState(false);
  useEffect(() => { list.current?.querySelector('.current')?.scrollIntoView({ block: 'nearest', inline: 'nearest', behavior: quiet() ? 'auto' : 'smooth' }); }, [state.value.current, models.length]);
  if (!model) return null;
  const most = 1.05 * Math.max(...models.flatMap(({ figures }) => [figures.systematic_high_um, figures.systematic_um, figures.noise_floor_um]).filter(Number.isFinite), 1e-3);
  const way = wayTo(models, model.number).filter(({ figures }) => Number.isFinite(figures.systematic_um));
  return (
    <section class="ladder" aria-label="Models and their errors">
      <Headline model={model} first={models[0]} former={beforeModel.value} />
      <ol class="chips" ref={list} tabindex="-1">{treeOf(models).map(({ model: each, depth, row, parentRow }) => <Chip key={each.number} model={each} depth={depth} row={row} parentRow={parentRow} most={most} />)}</ol>
      <details class="drawn-ladder" onToggle={(event) => setDrawn(event.currentTarget.open)}><summary>Draw the fall</summary>{drawn && <LadderDrawing models={way} />}</details>
    </section>
  );
}

function LadderDrawing({ models }) {
  const [make, setMake] = useState(() => makeWaterfall(models));
  const signature = JSON.stringify(models.map(({ figures }) => figures));
  useEffect(() => setMake(() => makeWaterfall(models)), [signature]);
  return <Drawing make={make} label="Systematic error on held-out lines after every step" />;
}
