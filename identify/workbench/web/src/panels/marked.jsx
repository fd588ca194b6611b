// What is marked, in words, and what can be done with it.
import { useEffect, useState } from 'preact/hooks';
import { count, decimalsFor, fixed, significant } from '../../../../report/web/src/dom.js';
import { leaveOut, report } from '../app/actions.js';
import { column, ensure } from '../app/columns.js';
import { lookAlong } from '../app/pictures.js';
import { mayAct, selection, shown, variables } from '../app/store.js';
import { view } from '../app/view.js';
import { emptySelection, meanOf, sharedValue, standOut } from '../data/selection.js';
import { directionsOf, directionWords } from '../data/variables.js';

/** "214 readings, mean +0.61 ± 0.05 µm, all with Y coming towards −". */
function markedSentence(now, chosen) {
  const { mean, u } = meanOf(now.now, chosen.mask, now.lines);
  const digits = decimalsFor(2 * u);
  const value = `${mean > 0 ? '+' : ''}${fixed(mean, digits)} ± ${significant(2 * u, 2)} ${now.unit}`;
  const shared = directionsOf(now.variables).flatMap((variable) => {
    const values = column(variable.name);
    const same = values ? sharedValue(values, chosen.mask) : null;
    return same === null ? [] : [directionWords(variable, same)];
  });
  const setups = column('setup') ? sharedValue(column('setup'), chosen.mask) : null;
  const where = setups === null ? [] : [`all of ${now.setups[setups]?.name}`];
  return [`${count(chosen.count)} ${chosen.count === 1 ? 'reading' : 'readings'}`, `mean ${value}`, ...shared, ...where].join(', ');
}

async function standsOut(chosen) {
  const names = variables.value.map(({ name }) => name);
  await ensure(names);
  const columns = Object.fromEntries(names.map((name) => [name, column(name)]));
  return standOut(variables.value, columns, chosen.mask, view.value?.shown ?? null);
}

function LeaveOut({ onDone }) {
  const [reason, setReason] = useState('');
  const send = (event) => {
    event.preventDefault();
    if (reason.trim() === '') return;
    onDone();
    leaveOut(reason.trim());
  };
  return (
    <form class="leave-out" onSubmit={send}>
      <label>Why? <input type="text" value={reason} ref={(node) => node?.focus()} onInput={(event) => setReason(event.currentTarget.value)} placeholder="cable moved" /></label>
      <button type="submit" disabled={reason.trim() === ''}>Leave them out</button>
      <button type="button" onClick={onDone}>No</button>
    </form>
  );
}

function Explanation({ list, onClose }) {
  const strong = list.slice(0, 4);
  return (
    <div class="explanation" role="status">
      {strong.length === 0 ? 'These readings differ from the others in no recorded variable.' : <>They differ from the others most in {strong.map(({ variable, difference }, k) => <span key={variable.name}>{k > 0 ? ', ' : ''}<b>{variable.label}</b> ({difference >= 20 ? 'wholly apart' : `${significant(difference, 2)} standard deviations`})</span>)}. The pictures show these.</>}
      {' '}Suspects that depend on them stand at the right. <button type="button" onClick={onClose}>Close</button>
    </div>
  );
}

const kHint = 'Drag in a picture to mark readings; they are marked in all of them. Shift adds. With the keyboard: arrow keys in a picture.';

export function Marked() {
  const chosen = selection.value;
  const now = view.value;
  const [asking, setAsking] = useState(false);
  const [explanation, setExplanation] = useState(null);
  const [sentence, setSentence] = useState('');
  useEffect(() => {
    setExplanation(null);
    if (!chosen.mask || !now) return setSentence('');
    ensure(directionsOf(now.variables).map(({ name }) => name)).then(() => setSentence(markedSentence(now, chosen)));
    return undefined;
  }, [chosen, now]);
  const clear = () => { selection.value = emptySelection; setAsking(false); };
  const explain = () => standsOut(chosen).then((list) => {
    setExplanation(list);
    lookAlong(list.slice(0, 3).map(({ variable }) => variable.name));
  }).catch((error) => report('explain', error));
  const alone = shown.value.alone;
  return (
    <section class={`marked ${chosen.mask ? 'some' : ''}`} aria-label="Marked readings">
      <p class="sentence" aria-live="polite">{chosen.mask ? sentence : kHint}</p>
      <span class="buttons">
        {chosen.mask && <button type="button" onClick={explain}>Explain this</button>}
        {chosen.mask && <button type="button" onClick={() => { shown.value = { ...shown.value, alone: chosen.mask }; }}>Show as a set-up of its own</button>}
        {chosen.mask && <button type="button" disabled={!mayAct.value} onClick={() => setAsking(true)}>Leave out …</button>}
        {chosen.mask && <button type="button" onClick={clear}>Clear</button>}
        {alone && <button type="button" class="primary" onClick={() => { shown.value = { ...shown.value, alone: null }; }}>Show all readings again</button>}
      </span>
      {asking && chosen.mask && <LeaveOut onDone={() => setAsking(false)} />}
      {explanation && <Explanation list={explanation} onClose={() => setExplanation(null)} />}
    </section>
  );
}
