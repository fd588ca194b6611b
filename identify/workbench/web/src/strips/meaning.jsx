// What the model means in the working volume, and what leaves the workbench.
import { useEffect, useState } from 'preact/hooks';
import { fixed, significant } from '../../../../report/web/src/dom.js';
import { latest, NoAnswer, Refusal } from '../api/call.js';
import { act, report } from '../app/actions.js';
import { busy, currentModel, exported, mayAct, modelName, state, unknowns } from '../app/store.js';
import { unitText } from '../data/variables.js';
import { words } from '../panels/parts.jsx';

const ask = latest();

function useMeaning() {
  const [got, setGot] = useState(null);
  const model = currentModel.value;
  const key = `${model?.number} ${model?.standing}`;
  useEffect(() => {
    if (!model || (busy.value && !busy.value.behind)) return;
    ask('meaning', {}).then((answer) => { if (answer) setGot({ ...answer, key }); }).catch((error) => {
      if (error instanceof NoAnswer) report('meaning', error);
      else if (!(error instanceof Refusal && error.status === 409)) setGot({ key, problem: error.message });
    });
  }, [key, busy.value === null]);
  return { got, stale: got?.key !== key };
}

function Share({ row, most }) {
  return (
    <tr><th scope="row">{words(row.label)}</th><td>{significant(row.um, 3)}{Number.isFinite(row.u95_um) ? ` ± ${significant(row.u95_um, 2)}` : ''}</td><td>{fixed(row.percent, 0)}</td><td aria-hidden="true"><span class="share" style={{ width: `${Math.max(0, Math.min(100, (100 * row.um) / most))}%` }} /></td></tr>
  );
}

function Volume({ got }) {
  const most = Math.max(...(got.share ?? []).map(({ um }) => um), 1e-9);
  return (
    <div>
      <h3>Error in the working volume, by cause</h3>
      <p>RMS <b>{significant(got.rms_um, 3)} µm</b>{got.tool ? ` at the tool ${got.tool}` : ''}.</p>
      {got.left && <p>Compensated by tables of this model: what the tables leave uncertain is <b>{significant(got.left.by_uncertainty_um, 3)} µm</b>; what time and temperature move, and no table holds, <b>{significant(got.left.by_time_and_temperature_um, 3)} µm</b>{got.left.held_by_no_table?.length > 0 ? ` (${got.left.held_by_no_table.join(', ')})` : ''}.</p>}
      {got.not_in_volume?.length > 0 && <p class="muted">Not an error of the volume: {got.not_in_volume.map(words).join(', ')}.</p>}
      <div class="table-frame"><table><caption class="hidden">Error in the working volume by cause</caption><thead><tr><th scope="col">Cause</th><th scope="col">µm</th><th scope="col">%</th><td /></tr></thead>
        <tbody>{(got.share ?? []).map((row) => <Share key={row.label} row={row} most={most} />)}</tbody></table></div>
    </div>
  );
}

function Detectable({ effects }) {
  return (
    <div>
      <h3>Smallest detectable effects</h3>
      <p class="muted">Anything smaller may be there: these readings find an effect of this size in four campaigns of five. Of every kind the one that is seen best.</p>
      <ul class="plain-list">{effects.slice(0, 14).map((effect) => <li key={`${effect.kind} ${effect.unit}`}>{effect.label}: {significant(effect.detectable, 2)} {unitText(effect.unit)}</li>)}</ul>
    </div>
  );
}

/** What tells apart what these readings do not, or shows what they cannot; found with what has no name. */
function Next() {
  const found = unknowns.value?.model === state.value.current && unknowns.value.ready ? unknowns.value.next : null;
  return (
    <div>
      <h3>What to measure next</h3>
      {!found && <p class="muted">It is being looked for.</p>}
      {found?.length === 0 && <p class="muted">No further measurement is called for.</p>}
      {found?.length > 0 && <ul class="plain-list next-measurements">{found.map((sentence) => <li key={sentence}>{words(sentence)}</li>)}</ul>}
    </div>
  );
}

export function Meaning() {
  const { got, stale } = useMeaning();
  const model = currentModel.value;
  return (
    <section class="meaning" aria-labelledby="meaning-title" aria-busy={stale}>
      <h2 id="meaning-title">What it means, with the model “{modelName(model)}”</h2>
      {!got && <p class="muted">The program computes the error in the volume.</p>}
      {got?.problem && <p>{words(got.problem)}</p>}
      {got && !got.problem && (
        <div class={`three ${stale ? 'is-stale' : ''}`}>
          <Volume got={got} />
          <Detectable effects={got.detectable ?? []} />
          <Next />
        </div>
      )}
    </section>
  );
}

const kExports = [['model', 'model file'], ['result', 'result'], ['diagnosis', 'diagnosis folder'], ['report', 'report'], ['commands', 'commands as a script']];

function CopyButton({ text }) {
  const [done, setDone] = useState('');
  const copy = () => navigator.clipboard.writeText(text).then(() => setDone('Copied.'), () => setDone('The browser does not let the page copy: mark the text and copy it.'));
  return <><button type="button" onClick={copy}>Copy</button> <span role="status">{done}</span></>;
}

export function Exports() {
  const { commands = [], output, campaign } = state.value;
  const text = commands.join('\n');
  return (
    <section class="exports" aria-labelledby="exports-title">
      <h2 id="exports-title">Take along</h2>
      <div class="two">
        <div>
          <p class="buttons">{kExports.map(([what, label]) => <button key={what} type="button" disabled={!mayAct.value} onClick={() => act('export', { what })}>Write the {label}</button>)}</p>
          <p class="muted">Into <code>{output}</code></p>
          {exported.value.length > 0 && <ul class="plain-list">{exported.value.flatMap(({ what, files }, n) => files.map((file) => <li key={`${n} ${file}`}>{what}: <code>{file}</code></li>))}</ul>}
        </div>
        <div>
          <h3>This session as commands</h3>
          <p class="muted">The same on the command line, for <code>{campaign.file}</code>:</p>
          <pre class="commands" tabindex="0" aria-label="Commands of this session">{text || 'nothing yet'}</pre>
          <CopyButton text={text} />
        </div>
      </div>
    </section>
  );
}
