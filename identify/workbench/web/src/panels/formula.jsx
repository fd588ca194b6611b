// A formula of one's own: looked at while it is typed.
import { useEffect, useRef, useState } from 'preact/hooks';
import { significant } from '../../../../report/web/src/dom.js';
import { latest, NoAnswer } from '../api/call.js';
import { add, report, showFormula } from '../app/actions.js';
import { chance } from '../app/sentences.js';
import { currentModel, mayAct, state } from '../app/store.js';
import { whenDrawn } from '../draw/schedule.js';
import { begin, painted } from '../draw/timing.js';
import { AddedVariable } from './added_variable.jsx';
import { bytesBefore, caretLine, columnOfByte, placeOfByte, taken } from './completion.js';
import { AmplitudeBar, amplitudeText, words } from './parts.jsx';

const kPause = 180; // ms without a key
const askFormula = latest();
const askWords = latest();

function useFormula(text, parameters) {
  const [result, setResult] = useState({ answer: null, error: null, of: '' });
  useEffect(() => {
    if (text.trim() === '') {
      askFormula.cancel();
      showFormula(null, '');
      setResult({ answer: null, error: null, of: '' });
      return undefined;
    }
    const timer = setTimeout(async () => {
      begin('formula');
      try {
        const list = parameters.split(/[;,]/).map((each) => each.trim()).filter(Boolean);
        const answer = await askFormula('formula', { text, parameters: list });
        if (!answer) return;
        showFormula(answer, text);
        setResult({ answer, error: null, of: text });
      } catch (error) {
        showFormula(null, '');
        if (error instanceof NoAnswer) report('formula', error);
        setResult({ answer: null, error, of: text });
      }
      whenDrawn(() => painted('formula'));
    }, kPause);
    return () => clearTimeout(timer);
  }, [text, parameters, state.value.current, currentModel.value?.standing]);
  return result;
}

function Suggestions({ list, chosen, onTake }) {
  return (
    <ul class="suggestions" id="formula-words" role="listbox" aria-label="Words that may stand here">
      {list.words.map(({ word, meaning }, k) => (
        <li key={word} id={`formula-word-${k}`} role="option" aria-selected={k === chosen} onMouseDown={(event) => { event.preventDefault(); onTake(word); }}><code>{word}</code> <span class="muted">{words(meaning)}</span></li>
      ))}
    </ul>
  );
}

function Problem({ error, text }) {
  const column = error.column ? columnOfByte(text, error.column) : null;
  return (
    <div id="formula-problem" class="problem" role="alert">
      {column ? <pre aria-hidden="true">{caretLine(column)}</pre> : null}
      <p><strong>{words(error.message)}</strong>{column ? ` (column ${column})` : ''}{error.remedy ? ` ${words(error.remedy)}` : ''}</p>
    </div>
  );
}

function Result({ answer, onAdd }) {
  const { effect, rivals = [], tried = 1 } = answer.head;
  const counted = Math.min(0, effect.log10_p + Math.log10(Math.max(1, tried)));
  return (
    <div class="result">
      <div class="is-preview-block">
        {effect.amplitudes.map((each) => <p key={each.label}>Amplitude <b>~&#8201;{amplitudeText(each)}</b> <AmplitudeBar amplitude={each} preview /></p>)}
        <p>Gain in log-likelihood <b>~&#8201;{significant(effect.gain, 3)}</b>; p <b>{chance(effect.log10_p)}</b>, counted over {tried} tried by hand: <b>{chance(counted)}</b>.</p>
        {effect.fall && Number.isFinite(effect.fall.to_um) && <p>RMS of held-out lines {significant(effect.fall.from_um, 3)} → <b>~{significant(effect.fall.to_um, 3)} µm</b>.</p>}
        {rivals.length > 0 && <p class="cosines">Alike (cosine of the angle between what both explain): {rivals.slice(0, 5).map(({ name, label, cosine }, k) => <span key={name ?? label} class={Math.abs(cosine) > 0.9 ? 'rivals' : ''}>{k > 0 ? ', ' : ''}{label} {significant(cosine, 2)}</span>)}.</p>}
        {effect.remedy && <p class="remedy">{words(effect.remedy)}</p>}
        <button type="button" class="primary" disabled={!mayAct.value || effect.can_be_added === false} onClick={onAdd}>Add this formula</button>
      </div>
      {answer.columns.driver && <AddedVariable driver={answer.columns.driver} effect={effect} />}
    </div>
  );
}

export function FormulaBox() {
  const [text, setText] = useState('');
  const [parameters, setParameters] = useState('');
  const [list, setList] = useState(null);
  const [chosen, setChosen] = useState(0);
  const input = useRef();
  const { answer, error, of } = useFormula(text, parameters);
  const suggest = async (value, at) => {
    const found = await askWords('complete', { text: value, at: bytesBefore(value, at) }).catch(() => null);
    setChosen(0);
    setList(found && found.words.length > 0 ? { ...found, from: placeOfByte(value, found.from), at } : null);
  };
  const typed = (event) => {
    const { value, selectionStart } = event.currentTarget;
    setText(value);
    if (value.trim() === '') setList(null);
    else suggest(value, selectionStart);
  };
  const take = (word) => {
    const next = taken(text, list.at, list.from, word);
    setText(next.text);
    setList(null);
    requestAnimationFrame(() => { input.current.focus(); input.current.setSelectionRange(next.at, next.at); });
  };
  /** What is in the model is no longer a try. */
  const addIt = () => {
    const { name } = answer.head.effect;
    setText('');
    add(name);
  };
  const key = (event) => {
    if (!list) {
      if (event.key === 'Enter' && answer && of === text && mayAct.value) { event.preventDefault(); addIt(); }
      return;
    }
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) { event.preventDefault(); setChosen((chosen + step + list.words.length) % list.words.length); }
    if (event.key === 'Enter' || event.key === 'Tab') { event.preventDefault(); take(list.words[chosen].word); }
    if (event.key === 'Escape') { event.preventDefault(); event.stopPropagation(); setList(null); }
  };
  return (
    <section class="formula-box" aria-labelledby="formula-title">
      <h2 id="formula-title">Try a formula</h2>
      <div class="formula-fields">
        <div class="field">
          <input ref={input} type="text" spellcheck={false} autocomplete="off" aria-label="Formula" placeholder="EXX += dir_x * (T_column - 20)" value={text} onInput={typed} onKeyDown={key} onBlur={() => setList(null)}
            role="combobox" aria-expanded={Boolean(list)} aria-controls="formula-words" aria-autocomplete="list" aria-activedescendant={list ? `formula-word-${chosen}` : undefined} aria-invalid={Boolean(error)} aria-describedby={error ? 'formula-problem' : undefined} />
          {list && <Suggestions list={list} chosen={chosen} onTake={take} />}
          {error && of === text && <Problem error={error} text={of} />}
        </div>
        <label class="parameters">Start values <input type="text" spellcheck={false} autocomplete="off" placeholder="p=250+-50" value={parameters} onInput={(event) => setParameters(event.currentTarget.value)} /></label>
      </div>
      {answer && <div class={of === text ? '' : 'is-stale'}><Result answer={answer} onAdd={addIt} /></div>}
    </section>
  );
}
