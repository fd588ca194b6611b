// The head of the page: whose readings, undo and redo, the full fit, the search, the theme.
import { useEffect, useState } from 'preact/hooks';
import { onThemeChange, toggleTheme } from '../../../../report/web/src/theme.js';
import { count } from '../../../../report/web/src/dom.js';
import { act, redo, undo } from '../app/actions.js';
import { unitText } from '../data/variables.js';
import { currentModel, line, mayAct, shown, state } from '../app/store.js';
import { unit, unitOfSetup, unitsPresent } from '../app/view.js';

const otherTheme = () => (document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');

function Theme() {
  const [other, setOther] = useState(otherTheme());
  useEffect(() => onThemeChange(() => setOther(otherTheme())), []);
  return <button type="button" onClick={toggleTheme}>{other} background</button>;
}

/** Which readings the pictures show. */
function Shown({ campaign }) {
  const set = (values) => { shown.value = { ...shown.value, ...values }; };
  return (
    <>
      {unitsPresent.value.length > 1 && <label class="menu"><span>readings in</span><select value={unit.value} onChange={(event) => set({ unit: event.currentTarget.value, setup: -1 })}>{unitsPresent.value.map((name) => <option key={name} value={name}>{unitText(name)}</option>)}</select></label>}
      <label class="menu"><span>of</span><select value={shown.value.setup} onChange={(event) => {
        const setup = Number(event.currentTarget.value);
        set({ setup, unit: setup < 0 ? shown.value.unit : unitOfSetup(campaign, setup) });
      }}><option value={-1}>all set-ups</option>{campaign.setups.map(({ name, readings }, k) => <option key={name} value={k}>{name} ({count(readings)})</option>)}</select></label>
    </>
  );
}

export function Header() {
  const now = state.value;
  const { campaign } = now;
  const model = currentModel.value;
  return (
    <header class="head">
      <h1><strong>volcal</strong> workbench <span class="of">{campaign?.machine ?? campaign?.file ?? ''}</span></h1>
      {campaign && <p class="muted" title={campaign.file}>{[String(campaign.file).split('/').slice(-2).join('/'), campaign.structure, `${count(campaign.observations)} readings in ${campaign.setups.length} set-ups`].filter(Boolean).join(', ')}</p>}
      <Notes />
      {now.phase === 'ready' && (
        <div class="buttons">
          <Shown campaign={campaign} />
          <button type="button" disabled={!mayAct.value || !now.can_undo} onClick={undo} title="Ctrl+Z" aria-keyshortcuts="Control+Z">Undo</button>
          <button type="button" disabled={!mayAct.value || !now.can_redo} onClick={redo} title="Ctrl+Shift+Z" aria-keyshortcuts="Control+Shift+Z">Redo</button>
          <button type="button" class={['preview', 'refitted'].includes(model?.standing) ? 'primary' : ''} disabled={!mayAct.value} onClick={() => act('confirm')} title="Full fit of the current model, noise and smoothing anew">Confirm by a full fit</button>
          <button type="button" disabled={!mayAct.value} onClick={() => act('climb')} title="Adds what exceeds chance, one after the other">Search to the end</button>
          <Theme />
          <button type="button" disabled={line.value !== 'open'} onClick={() => act('quit')}>Quit</button>
        </div>
      )}
    </header>
  );
}

function Notes() {
  const { notes = [], left_out: leftOut = [] } = state.value;
  if (notes.length + leftOut.length === 0) return null;
  return (
    <details class="notes"><summary>{notes.length > 0 ? `${notes.length} ${notes.length === 1 ? 'note' : 'notes'} on this campaign` : ''}{notes.length > 0 && leftOut.length > 0 ? '; ' : ''}{leftOut.length > 0 ? `${count(leftOut.reduce((sum, { readings }) => sum + readings, 0))} readings left out` : ''}</summary>
      <ul>{notes.map((note) => <li key={note}>{note}</li>)}{leftOut.map(({ readings, reason }) => <li key={reason}>{count(readings)} readings left out: {reason}</li>)}</ul>
    </details>
  );
}
