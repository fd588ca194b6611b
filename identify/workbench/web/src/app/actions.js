// What a click does.
import { call, latest, NoAnswer, Refusal } from '../api/call.js';
import { abandon, begin, painted } from '../draw/timing.js';
import { whenDrawn } from '../draw/schedule.js';
import { emptySelection, indices } from '../data/selection.js';
import { clearColumns, ensure, keep, kFirst, residualNames } from './columns.js';
import { columnsOfPictures, openOn, openPictures, pictures, shiftOf, variablesIn } from './pictures.js';
import { fallSentence } from './sentences.js';
import { beforeModel, busy, chosenBefore, currentModel, exported, line, preview, ranking, rankingBusy, said, selection, shown, state, surfaces, trouble, unknowns, variables } from './store.js';

export function report(what, error) {
  if (error instanceof NoAnswer) line.value = 'gone';
  else trouble.value = { what, error: error.message, remedy: error.remedy ?? null };
}

/** Takes over a state that the program sent. */
async function takeState(next) {
  const former = state.value;
  if (former && next.revision !== undefined && next.revision < former.revision) return;
  const sentence = former ? fallSentence(former, next) : null;
  const isAdded = adding !== null && former?.current !== next.current;
  state.value = next;
  busy.value = next.busy ?? null;
  watchDrawing();
  if (next.campaign?.file !== former?.campaign?.file || next.campaign?.observations !== former?.campaign?.observations) forgetReadings();
  if (next.phase !== 'ready') return;
  if (pictures.value.length === 0) openPictures();
  if (sentence) said.value = sentence;
  if (former?.current !== next.current) {
    keepWhatWasLookedAt(former);
    preview.value = null;
  }
  await ensure([...kFirst, ...residualNames(currentModel.value, beforeModel.value), ...columnsOfPictures()]).catch((error) => report('columns', error));
  if (isAdded) whenDrawn(() => painted('add'));
  lookAgain();
}

/** The residuals that an effect would leave are those of the linear model with it. */
function keepWhatWasLookedAt(former) {
  const { number, parent, standing } = currentModel.value ?? {};
  if (!preview.value || preview.value.name !== adding || standing !== 'preview' || parent !== former?.current) return;
  keep(`residual@${number}`, preview.value.residual);
}

/** What is missing now: asked for, not waited for. */
async function lookAgain() {
  if (ranking.value?.model !== state.value.current || ranking.value?.standing !== currentModel.value?.standing) await rank();
  if (busy.value === null || busy.value.behind) askUnknown();
}

function forgetReadings() {
  clearColumns();
  selection.value = emptySelection;
  shown.value = { unit: null, setup: -1, alone: null };
  ranking.value = null;
  unknowns.value = null;
  pictures.value = [];
}

const askRank = latest();

/** What has no name is looked for behind: asked for until it is there. */
async function askUnknown() {
  const model = state.value.current;
  const known = unknowns.value;
  if (known?.ready && known.model === model && known.standing === currentModel.value?.standing) return;
  try {
    takeUnknown(await call('unknown', {}));
  } catch (error) {
    if (!(error instanceof Refusal && error.status === 409)) report('unknown', error);
  }
}

function takeUnknown(answer) {
  if (answer.model !== state.value.current) return;
  unknowns.value = { ...answer, standing: currentModel.value?.standing };
  keepSurfaces(answer.drawn ?? [], answer.model);
  if (answer.unknown[0]) openOn([null, ...answer.unknown[0].variables], shiftOf(answer.unknown[0]));
}

async function rank() {
  const [model, standing] = [state.value.current, currentModel.value?.standing];
  rankingBusy.value = true;
  begin('rank');
  try {
    const answer = await askRank('rank', {});
    if (!answer) return;
    ranking.value = { ...answer, model, standing };
    if (answer.effects[0]) openOn(variablesIn(answer.effects[0].driver ?? '').slice(0, 1), shiftOf(answer.effects[0]));
    whenDrawn(() => painted('rank'));
    rankingBusy.value = false;
    // What a menu may ask for next is here before it does.
    ensure(variables.value.map(({ name }) => name)).catch(() => {});
  } catch (error) {
    rankingBusy.value = false;
    if (!(error instanceof Refusal && error.status === 409)) report('rank', error);
  }
}

/** An action that answers with the new state. */
export async function act(name, body = {}) {
  try {
    const next = await call(name, body);
    if (next?.models) await takeState(next);
    else if (next?.busy) busy.value = next.busy;
    return true;
  } catch (error) {
    report(name, error);
    return false;
  }
}

let adding = null;

export async function add(effect) {
  begin('add');
  adding = effect;
  if (!await act('add', { effect })) abandon('add');
  adding = null;
}

/** A law that stands behind a surface: tried as a formula, then added by the name that it got. */
export async function addFormula({ name, text, parameters = [] }) {
  if (name) return add(name);
  try {
    const { head } = await call('formula', { text, parameters });
    return add(head.effect.name);
  } catch (error) {
    return report('formula', error);
  }
}

let drawing = null;

/** Draws what has no name. A program that is done and has sent no surface has found none. */
export async function draw(unknown) {
  drawing = { surfaces: surfaces.value.length, begun: false };
  if (!await act('draw', { unknown })) drawing = null;
}

function watchDrawing() {
  if (!drawing) return;
  if (busy.value?.what === 'draw') drawing.begun = true;
  else if (drawing.begun) {
    const none = surfaces.value.length === drawing.surfaces && !trouble.value;
    drawing = null;
    if (none) trouble.value = { what: 'draw', error: 'No curve or surface of it can be drawn from the readings.', remedy: 'Look along its variables: a suspect with a name may explain it.' };
  }
}

export const go = (model) => act('go', { model });
export const undo = () => state.value?.can_undo && act('undo');
export const redo = () => state.value?.can_redo && act('redo');
export const compareWith = (number) => {
  chosenBefore.value = number;
  ensure(residualNames(beforeModel.value)).catch((error) => report('columns', error));
};

const askPreview = latest();
const looked = new Map();
let wanted = null;

const previewKey = (effect) => `${state.value.current} ${currentModel.value?.standing} ${effect}`;

function showPreview(key, answer, label) {
  if (looked.size > 60) looked.delete(looked.keys().next().value);
  looked.set(key, answer);
  const { head, columns } = answer;
  preview.value = { name: wanted, label, residual: columns.residual, ...head };
  whenDrawn(() => painted('hover'));
}

/** Looks at an effect before it is added; a later wish replaces the one that is not answered yet. */
export async function look(effect, label) {
  if (wanted === effect) return;
  wanted = effect;
  begin('hover');
  const key = previewKey(effect);
  try {
    const answer = looked.get(key) ?? await askPreview('preview', { effect });
    if (answer && wanted === effect) showPreview(key, answer, label);
  } catch (error) {
    if (wanted === effect && error instanceof NoAnswer) report('preview', error);
  }
}

export function lookAway(effect) {
  if (wanted !== effect) return;
  wanted = null;
  abandon('hover');
  askPreview.cancel();
  preview.value = null;
}

/** What a formula would do is looked at like an effect. */
export function showFormula(answer, text) {
  wanted = `formula:${text}`;
  preview.value = answer ? { name: wanted, label: text, residual: answer.columns.residual, ...answer.head } : null;
}

export function leaveOut(reason) {
  const observations = indices(selection.value.mask);
  selection.value = emptySelection;
  shown.value = { ...shown.value, alone: null };
  return act('leave-out', { observations, reason });
}

/** Events of the program. */
export function onEvent(name, data) {
  if (name === 'state') takeState(data);
  else if (name === 'progress') busy.value = data.busy === undefined ? data : data.busy;
  else if (name === 'unknown') takeUnknown(data);
  else if (name === 'surface') takeSurface(data);
  else if (name === 'exported') takeExported(data);
  else if (name === 'failed') trouble.value = data;
  else if (name === 'bye') line.value = 'ended';
}

/** Surfaces of a model, each once. */
function keepSurfaces(list, model) {
  const names = new Set(list.map(({ name }) => name));
  surfaces.value = [...surfaces.value.filter((each) => each.model !== model || !names.has(each.name)), ...list.map((surface) => ({ ...surface, model }))];
}

function takeSurface(surface) {
  keepSurfaces([surface], state.value.current);
  said.value = `${surface.label} is drawn.`;
}

function takeExported(done) {
  exported.value = [...exported.value, done];
  said.value = `${done.what} is written: ${done.files.join(', ')}.`;
}

export async function onLine(status) {
  if (line.value === 'ended') return;
  line.value = status;
  if (status !== 'open') return;
  try {
    await takeState(await call('state', {}));
  } catch (error) {
    report('state', error);
  }
}

