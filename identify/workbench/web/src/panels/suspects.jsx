// Suspects: what is missing in the model, ranked; what is in it; what these readings cannot show.
import { useState } from 'preact/hooks';
import { significant } from '../../../../report/web/src/dom.js';
import { act, add, look, lookAway } from '../app/actions.js';
import { lookAlong, shiftOf, variablesIn } from '../app/pictures.js';
import { chance } from '../app/sentences.js';
import { busy, currentModel, mayAct, modelName, modelOf, preview, ranking, rankingBusy, state, unknowns } from '../app/store.js';
import { sketchOf } from '../data/sketch.js';
import { unitText } from '../data/variables.js';
import { AmplitudeBar, amplitudeText, partOf, Sketch, timesDetectable, words } from './parts.jsx';
import { Drawn, Unknowns } from './unknowns.jsx';

const kFirst = 12;

const largest = (effect) => effect.amplitudes.reduce((best, each) => ((timesDetectable(each) ?? 0) > (timesDetectable(best) ?? 0) ? each : best), effect.amplitudes[0]);

function Amplitudes({ effect, sign = '' }) {
  if (!effect.amplitudes?.length) return null;
  const main = largest(effect);
  const times = timesDetectable(main);
  return (
    <span class="amplitudes">
      <span class="values">{effect.amplitudes.map((each) => `${partOf(effect, each)} ${sign && `${sign}\u2009`}${amplitudeText(each)}`.trim()).join('; ')}</span>
      <AmplitudeBar amplitude={main} preview={sign === '~'} />
      {times !== null && <span class="muted small">{significant(times, 2)} × the smallest detectable, {significant(main.detectable, 2)} {unitText(main.unit)}</span>}
    </span>
  );
}

function Fall({ fall }) {
  if (!fall || !Number.isFinite(fall.from_um) || !Number.isFinite(fall.to_um)) return null;
  return <span class="fall">Held-out RMS {significant(fall.from_um, 3)} → <b>~{significant(fall.to_um, 3)} µm</b></span>;
}

const kNamed = 3;

/** The first names, and how many more there are. */
const listed = (names) => (names.length > kNamed + 1 ? `${names.slice(0, kNamed).join(', ')} and ${names.length - kNamed} more` : names.join(', '));

function Suspect({ effect }) {
  const hovered = preview.value?.name === effect.name;
  const usable = effect.can_be_added !== false;
  const may = mayAct.value && usable;
  const along = effect.driver ? variablesIn(effect.driver) : variablesIn(effect.name);
  const look_ = () => look(effect.name, effect.label);
  const away = () => lookAway(effect.name);
  return (
    <li class={`suspect ${hovered ? 'looked-at' : ''} ${usable ? '' : 'unseen'}`}>
      <div class="row" onMouseEnter={look_} onMouseLeave={away} onClick={() => may && add(effect.name)}>
        <Sketch points={effect.sketch ?? sketchOf(effect)} label={effect.label} />
        <span class="body" id={`about-${effect.name}`}>
          <span class="title"><b>{effect.label}</b>{effect.shape ? <span class="muted">, {words(effect.shape)}</span> : ''}<span class="p muted" title="Probability of so much by chance">p {chance(effect.log10_p)}</span></span>
          <span class="plain">{words(effect.words)}</span>
          <Amplitudes effect={effect} sign="~" />
          <Fall fall={effect.fall} />
          {effect.rivals?.length > 0 && <span class="rivals">These readings hardly tell it from {listed(effect.rivals.map((rival) => rival.label ?? rival))}.</span>}
          {effect.can_be_added === false && !effect.remedy && <span class="remedy">The error function needs more knots: give it more in the model file.</span>}
          {!usable && effect.remedy && <span class="remedy">{words(effect.remedy)}</span>}
        </span>
        <button type="button" class="add" aria-label={`add ${effect.label}`} aria-describedby={`about-${effect.name}`} aria-disabled={!may} onFocus={look_} onBlur={away} onClick={(event) => { event.stopPropagation(); if (may) add(effect.name); }}>add</button>
      </div>
      <div class="under">
        {along.length > 0 && <button type="button" class="along" onClick={() => lookAlong(along, shiftOf(effect))}>Look along {along.join(', ')}</button>}
        {effect.causes && <details><summary>usual causes</summary><p>{words(effect.causes)}.</p></details>}
      </div>
    </li>
  );
}

/** The effects of the current model, with what it takes to be without them. */
function InModel() {
  const model = currentModel.value;
  const effects = model?.effects ?? [];
  if (effects.length === 0) return null;
  return (
    <section class="in-model" aria-labelledby="in-model-title">
      <h3 id="in-model-title">In this model</h3>
      <ul>{effects.map((effect) => (
        <li key={effect.name} class={`is-${model.standing}`}>
          <span class="body"><b>{effect.label}</b> <Amplitudes effect={effect} sign={model.standing === 'preview' || model.standing === 'refitted' ? '~' : ''} />{effect.remedy && <span class="remedy">{words(effect.remedy)}</span>}</span>
          <button type="button" disabled={!mayAct.value} aria-label={`take out: ${effect.label}`} onClick={() => act('remove', { effect: effect.name })}>take out</button>
        </li>
      ))}</ul>
    </section>
  );
}

const kRemedy = 'The readings are hardly sensitive to it: measure where it acts, or from another side.';

function NotVisible({ effects }) {
  if (!effects?.length) return null;
  return (
    <details class="not-visible"><summary>{effects.length} effects that these readings cannot show</summary>
      <ul>{effects.map((effect) => <li key={effect.name}><b>{effect.label}</b> <span class="remedy">{effect.remedy ? words(effect.remedy) : kRemedy}</span></li>)}</ul>
    </details>
  );
}

/** Numbers of another model than the current one are out of date. */
const isStale = () => ranking.value && (ranking.value.model !== state.value.current || ranking.value.standing !== currentModel.value?.standing);

const kRisk = Math.log10(0.05); // of one exceedance by chance in the whole catalogue

/** p counted over the catalogue and what was tried by hand. */
const countedOver = ({ tests = 1, tried = 0 }) => Math.log10(Math.max(1, tests + tried));

function Rank({ answer }) {
  const [all, setAll] = useState(false);
  const exceeding = answer.effects.filter((effect) => effect.log10_p + countedOver(answer) < kRisk);
  const below = answer.effects.slice(exceeding.length);
  const found = unknowns.value?.model === state.value.current ? unknowns.value : null;
  const list = found?.unknown ?? [];
  const unknown = <Unknowns list={list} />;
  return (
    <>
      <Drawn />
      {found?.unknown_leads && unknown}
      {exceeding.length === 0 && list.length === 0 && found?.ready && <p class="nothing">No test of the catalogue exceeds what chance gives. What is smaller than the smallest detectable amplitude may still be there.</p>}
      <ol class="rows">{(all ? exceeding : exceeding.slice(0, kFirst)).map((effect) => <Suspect key={effect.name} effect={effect} />)}</ol>
      {exceeding.length > kFirst && <button type="button" onClick={() => setAll(!all)}>{all ? 'The first alone' : `All ${exceeding.length}`}</button>}
      {!found?.unknown_leads && unknown}
      {!found?.ready && <p class="muted looking">What has no name is being looked for.</p>}
      <Below effects={below} />
      <NotVisible effects={answer.not_visible} />
    </>
  );
}

/** What chance alone may give: still to be tried. */
function Below({ effects }) {
  const [open, setOpen] = useState(false);
  if (effects.length === 0) return null;
  return (
    <details class="not-visible" onToggle={(event) => setOpen(event.currentTarget.open)}><summary>{effects.length} that chance alone may give</summary>
      {open && <ol class="rows">{effects.map((effect) => <Suspect key={effect.name} effect={effect} />)}</ol>}
    </details>
  );
}

export function Suspects() {
  const answer = ranking.value;
  const stale = isStale();
  const model = modelOf(state.value.current);
  return (
    <section class={`suspects ${stale ? 'is-stale' : ''}`} aria-labelledby="suspects-title">
      <h2 id="suspects-title">What is missing?</h2>
      <p class="muted" role="status">{!answer ? (busy.value ? 'Ranked when the program is free.' : 'The catalogue is ranked.') : stale || rankingBusy.value ? 'Ranked anew for this model.' : `${answer.tests ?? ''} tests of “${modelName(model)}”${state.value.tried > 0 ? `; ${state.value.tried} tried by hand, counted in every p` : ''}. Point at a row to see it in the pictures, click to add it.`}</p>
      <InModel />
      {answer && <Rank answer={answer} />}
    </section>
  );
}

