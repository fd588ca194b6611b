// All that the page knows, as signals.
import { computed, signal } from '@preact/signals';
import { tab } from '../api/call.js';
import { emptySelection } from '../data/selection.js';
import { variablesOf } from '../data/variables.js';

/** What the program said last. */
export const state = signal(null);
/** 'connecting', 'open', 'gone' (does not answer), 'refused' (wrong address), 'ended'. */
export const line = signal('connecting');
export const busy = signal(null);
/** Something that went wrong: { what, error, remedy }, until it is closed. */
export const trouble = signal(null);
/** Sentence for those who hear the page. */
export const said = signal('');

/** Model that is compared with the current one, as chosen; null: the model before. */
export const chosenBefore = signal(null);
export const selection = signal(emptySelection);
/** What the lenses show of the readings: lengths or angles, one set-up or all, and those that are marked alone. */
export const shown = signal({ unit: null, setup: -1, alone: null });
/** A change that is only looked at: { name, label, residual, figures, effect, rivals }. */
export const preview = signal(null);
/** Answer to `rank`, with the model it belongs to. */
export const ranking = signal(null);
/** Answer to `unknown`: what stands out without a name. */
export const unknowns = signal(null);
export const rankingBusy = signal(false);
export const surfaces = signal([]);
export const exported = signal([]);

export const currentModel = computed(() => modelOf(state.value?.current));
export const campaign = computed(() => state.value?.campaign ?? null);
export const variables = computed(() => (campaign.value ? variablesOf(campaign.value) : []));
/** A program that only reads does all but write files; one tab at a time changes the model. */
export const isWriter = computed(() => Boolean(state.value) && (state.value.writer_tab === undefined ? state.value.writer !== false : ['', tab].includes(state.value.writer_tab)));
const mayWrite = computed(() => line.value === 'open' && isWriter.value);
/** What runs behind the user's back gives way to what the user does. */
export const mayAct = computed(() => mayWrite.value && state.value.phase === 'ready' && (busy.value === null || Boolean(busy.value.behind)));

export function modelOf(number) {
  return state.value?.models?.find((model) => model.number === number) ?? null;
}

/** The model in grey: the one chosen, else the one that the current model was made from. */
export const beforeModel = computed(() => {
  const chosen = modelOf(chosenBefore.value);
  if (chosen && chosen.number !== state.value.current) return chosen;
  return modelOf(currentModel.value?.parent ?? null);
});

/** "+ reversal EXX", "− 12 readings: cable moved". */
export function modelName({ change }) {
  if (!change) return 'as given';
  return /^[+\-−]/.test(change) ? change.replace(/^-\s*/, '− ') : `+ ${change}`;
}
