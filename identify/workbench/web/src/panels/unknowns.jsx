// What stands out without a name: first named by its variables, then drawn, then added as a surface or a formula.
import { useEffect, useState } from 'preact/hooks';
import { significant } from '../../../../report/web/src/dom.js';
import { surfaceFigures } from '../../../../report/web/src/lenses/surface.js';
import { add, addFormula, draw } from '../app/actions.js';
import { lookAlong, shiftOf } from '../app/pictures.js';
import { chance } from '../app/sentences.js';
import { busy, currentModel, mayAct, state, surfaces, variables } from '../app/store.js';
import { outlineOf, surfaceData } from '../data/surface.js';
import { unitText } from '../data/variables.js';
import { Drawing, words } from './parts.jsx';

function Figure({ figure }) {
  const [make] = useState(() => () => {
    const { data, layout } = figure.make();
    return { data, layout: { ...layout, height: Math.min(layout.height, 300), margin: { ...layout.margin, r: Math.min(layout.margin?.r ?? 10, 70) } } };
  });
  return <figure><figcaption>{figure.caption}</figcaption><Drawing make={make} label={figure.caption} /></figure>;
}

function Formula({ formula }) {
  return (
    <li class="formula">
      <code>{formula.text ?? formula.label}</code>
      <span>{significant(formula.amplitude, 3)} ± {significant(formula.u95, 2)} {unitText(formula.unit)}, log evidence {significant(formula.log_evidence, 3)}{formula.shape ? `, ${words(formula.shape)}` : ''}</span>
      <button type="button" disabled={!mayAct.value} aria-label={`Add ${formula.text ?? formula.label}`} onClick={() => addFormula(formula)}>Add</button>
    </li>
  );
}

/** What the picture shows, in words. */
function Outline({ surface }) {
  const { largest, u95, at, from, to } = outlineOf(surface);
  const drivers = surfaceData(surface, variables.value).axes.map(({ name, title }) => ({ name, unit: title.match(/\[(.*)\]/)?.[1] ?? '' }));
  const placed = (k, value) => `${significant(value, 3)}${drivers[k].unit ? ` ${drivers[k].unit}` : ''}`;
  return (
    <p class="outline">Largest <b>{significant(largest, 3)} ± {significant(u95, 2)} {unitText(surface.unit)}</b> at {drivers.map(({ name }, k) => `${name} = ${placed(k, at[k])}`).join(', ')}; at least half of it {drivers.map(({ name }, k) => `from ${name} = ${placed(k, from[k])} to ${placed(k, to[k])}`).join(' and ')}.</p>
  );
}

function Surface({ surface }) {
  const [figures, setFigures] = useState([]);
  useEffect(() => setFigures(surfaceFigures(surfaceData(surface, variables.value))), [surface]);
  return (
    <div class="surface-drawn">
      <Outline surface={surface} />
      {figures.slice(0, 1).map((figure) => <Figure key={figure.caption} figure={figure} />)}
      <button type="button" class="primary" disabled={!mayAct.value} onClick={() => add(surface.name)}>Add the {surface.drivers.length > 1 ? 'surface' : 'curve'}</button>
      {figures.slice(1).map((figure) => <Figure key={figure.caption} figure={figure} />)}
      {surface.free?.length > 0 && <p class="muted">These readings leave open {surface.free.map(words).join('; ')}.</p>}
      {surface.formulas?.length > 0 && <><p>Laws that may stand behind it:</p><ul class="formulas">{surface.formulas.map((formula) => <Formula key={formula.text ?? formula.label} formula={formula} />)}</ul></>}
    </div>
  );
}

function Unknown({ unknown }) {
  const drawing = busy.value?.what === 'draw';
  const thing = unknown.variables.length > 1 ? 'surface' : 'curve';
  return (
    <li class="unknown">
      <p class="title"><b>{words(unknown.label)}</b> <span class="p muted">p {chance(unknown.log10_p ?? Math.log10(Number(unknown.p)))}</span></p>
      <p>{words(unknown.words)}.</p>
      <p class="buttons">
        <button type="button" class="primary" disabled={!mayAct.value} onClick={() => draw(unknown.number)}>{drawing ? 'Being drawn' : `Draw the ${thing}`}</button>
        <button type="button" onClick={() => lookAlong(unknown.variables, shiftOf(unknown))}>Look along {unknown.variables.join(', ')}</button>
      </p>
    </li>
  );
}

/** Surfaces that are drawn for the current model. */
export function Drawn() {
  const inModel = new Set((currentModel.value?.effects ?? []).map(({ name }) => name));
  const list = surfaces.value.filter((surface) => surface.model === state.value.current && !inModel.has(surface.name));
  if (list.length === 0) return null;
  return (
    <ul class="unknowns" aria-label="Drawn without a name">{list.map((surface) => (
      <li key={surface.name} class="unknown"><p class="title"><b>{words(surface.label)}</b></p><Surface surface={surface} /></li>
    ))}</ul>
  );
}

export function Unknowns({ list }) {
  if (list.length === 0) return null;
  return <ul class="unknowns" aria-label="Without a name">{list.map((unknown) => <Unknown key={unknown.number} unknown={unknown} />)}</ul>;
}
