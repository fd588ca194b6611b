// The page of volcal workbench.
import { effect } from '@preact/signals';
import { render } from 'preact';
import { keepLine } from './api/events.js';
import { onEvent, onLine } from './app/actions.js';
import { kMostPictures, open, pictures } from './app/pictures.js';
import { listenToKeys } from './app/shortcuts.js';
import { campaign, currentModel, line, preview, said, state } from './app/store.js';
import { Card } from './lenses/card.jsx';
import { lenses } from './lenses/registry.js';
import { FormulaBox } from './panels/formula.jsx';
import { Marked } from './panels/marked.jsx';
import { Suspects } from './panels/suspects.jsx';
import { Header } from './strips/header.jsx';
import { Ladder } from './strips/ladder.jsx';
import { Exports, Meaning } from './strips/meaning.jsx';
import { BadInput, Line, Progress, ReadOnly, Stale, Trouble } from './strips/status.jsx';

function Legend() {
  return (
    <p class="legend" aria-label="Colours of the pictures">
      <span class="key"><i class="dot before" />before</span><span class="key"><i class="dot now" />now</span>
      <span class="key"><i class="dot looked" />{preview.value ? `~ ${preview.value.label}: dots are what it explains, dashed means what would remain` : 'looked at'}</span><span class="key"><i class="dot chosen" />marked</span>
    </p>
  );
}

function WhereItFails() {
  const list = pictures.value;
  return (
    <section class="fails" aria-labelledby="fails-title">
      <div class="fails-head"><h2 id="fails-title">Where it fails</h2><Legend />
        {list.length < kMostPictures && <label class="menu"><span>open another</span><select value="" onChange={(event) => { open(event.currentTarget.value); event.currentTarget.value = ''; }}><option value="">lens …</option>{Object.values(lenses).map(({ kind, title }) => <option key={kind} value={kind}>{title}</option>)}</select></label>}
      </div>
      <Marked />
      <div class="lenses" data-count={list.length}>{list.map((config) => <Card key={config.key} config={config} />)}</div>
    </section>
  );
}

function Ready() {
  return (
    <>
      <div class="top"><Ladder /></div>
      <div class="centre"><div><WhereItFails /><FormulaBox /></div><Suspects /></div>
      <Meaning />
      <Exports />
    </>
  );
}

const loading = () => <p class="loading" role="status">{state.value?.phase === 'loading' ? 'The program reads the campaign and fits it.' : 'The page waits for the program.'}</p>;

function Page() {
  const now = state.value;
  const ready = now?.phase === 'ready' && currentModel.value;
  return (
    <>
      {now ? <Header /> : <header class="head"><h1><strong>volcal</strong> workbench</h1></header>}
      <Progress />
      <main>
        <Line retry={retry} /><ReadOnly /><Stale /><Trouble />
        {now?.phase === 'bad-input' && <BadInput />}
        {ready ? <Ready /> : now?.phase === 'bad-input' || line.value === 'refused' || line.value === 'ended' ? null : loading()}
      </main>
      <p class="hidden" role="status" aria-live="polite" id="said">{said.value}</p>
    </>
  );
}

let retry = () => {};

function start() {
  listenToKeys();
  effect(() => { document.title = campaign.value ? `${campaign.value.machine ?? campaign.value.file}: volcal workbench` : 'volcal workbench'; });
  const root = document.getElementById('workbench');
  root.replaceChildren();
  render(<Page />, root);
  retry = keepLine(onLine, onEvent);
}

start();
