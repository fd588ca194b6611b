// What stands in the way, in words: progress, bad input, another tab, a program that does not answer.
import { useEffect, useState } from 'preact/hooks';
import { act } from '../app/actions.js';
import { seconds } from '../app/sentences.js';
import { busy, isWriter, line, mayAct, state, trouble } from '../app/store.js';
import { words } from '../panels/parts.jsx';

const kDoing = { confirm: 'Full fit of this model', climb: 'Search to the end', draw: 'Drawing what has no name', scan: 'Looking for what has no name', prepare: 'Preparing what leads', 'leave-out': 'Fit without these readings', remove: 'Fit without this effect', export: 'Writing', load: 'Reading the campaign', fit: 'Fit of the campaign' };

export function Progress() {
  const now = busy.value;
  if (!now) return null;
  const share = Number.isFinite(now.share) ? Math.max(0, Math.min(1, now.share)) : null;
  const title = kDoing[now.what] ?? now.what;
  return (
    <div class="progress" role="status" data-behind={now.behind ? "" : undefined}>
      <span><strong>{title}</strong>{now.stage ? `: ${now.stage}` : ''}</span>
      <progress aria-label={title} max="1" value={share ?? undefined} />
      <span class="muted">{share !== null ? `${Math.round(100 * share)} %` : ''}{now.left_s !== null && now.left_s !== undefined ? `, ${seconds(now.left_s)}` : ''}</span>
      <button type="button" onClick={() => act('cancel')}>Cancel</button>
    </div>
  );
}

export function Trouble() {
  const wrong = trouble.value;
  if (!wrong) return null;
  return (
    <div class="banner bad" role="alert">
      <p><strong>{words(wrong.error)}</strong>{wrong.remedy ? ` ${words(wrong.remedy)}` : ''}</p>
      <p class="muted">The model is as it was before.</p>
      <button type="button" onClick={() => { trouble.value = null; }}>Close</button>
    </div>
  );
}

function useSeconds(on) {
  const [passed, setPassed] = useState(0);
  useEffect(() => {
    if (!on) return undefined;
    const timer = setInterval(() => setPassed((n) => n + 1), 1000);
    return () => clearInterval(timer);
  }, [on]);
  return passed;
}

export function Line({ retry }) {
  const status = line.value;
  const passed = useSeconds(status === 'gone');
  if (status === 'open' || status === 'connecting') return null;
  if (status === 'ended') return <div class="banner" role="alert"><p><strong>The program has ended.</strong> What was exported is on the disk; start <code>volcal workbench</code> again to go on.</p></div>;
  if (status === 'refused') return <div class="banner bad" role="alert"><p><strong>This address does not open the workbench.</strong> Use the address that <code>volcal workbench</code> prints, with all that stands behind #.</p></div>;
  return (
    <div class="banner bad" role="alert">
      <p><strong>The program does not answer.</strong> The numbers are as last heard. If it was ended, start <code>volcal workbench</code> again.{passed > 5 ? ' The page keeps trying.' : ''}</p>
      <button type="button" onClick={retry}>Try again</button>
    </div>
  );
}

export function ReadOnly() {
  const now = state.value;
  if (!now || line.value !== 'open' || isWriter.value) return null;
  return (
    <div class="banner" role="status">
      <p><strong>Another tab writes.</strong> Here everything can be looked at.</p>
      <button type="button" onClick={() => act('take')}>Write here</button>
    </div>
  );
}

/** Files that were written since they were loaded. */
export function Stale() {
  const changed = state.value?.phase === 'ready' ? state.value.stale ?? [] : [];
  if (changed.length === 0) return null;
  return (
    <div class="banner" role="status">
      <p><strong>Changed on the disk since it was loaded: {changed.join(', ')}.</strong> The numbers are those of the files as they were. Loading again begins anew; export what is to be kept first.</p>
      <button type="button" disabled={!mayAct.value} onClick={() => act('reload')}>Load again</button>
    </div>
  );
}

/** File, line and remedy beside the lines of the file. */
export function BadInput() {
  const wrong = state.value?.input_error;
  if (!wrong) return null;
  return (
    <section class="bad-input" aria-labelledby="bad-input-title">
      <div class="banner bad" role="alert">
        <h2 id="bad-input-title">{wrong.file}{wrong.line ? `, line ${wrong.line}` : ''}</h2>
        <p><strong>{words(wrong.problem)}</strong></p>
        {wrong.remedy && <p>{words(wrong.remedy)}</p>}
        <p class="muted">Mend this file, or the one that is wrong, and save it: the page goes on by itself.</p>
      </div>
      <pre class="source" tabindex="0" aria-label={`Lines of ${wrong.file}`}>{(wrong.text ?? []).map(({ line: number, text }) => (
        <span key={number} class={number === wrong.line ? 'wrong' : ''}><span class="number">{number}</span>{text}{'\n'}</span>
      ))}</pre>
    </section>
  );
}
