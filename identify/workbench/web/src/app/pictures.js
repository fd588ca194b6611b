// Which lenses are open, and what they show.
import { effect, signal } from '@preact/signals';
import { directionsOf, timeOf } from '../data/variables.js';
import { lenses } from '../lenses/registry.js';
import { campaign, variables } from './store.js';

/** [{ key, kind, x, y, of, perSigma, ... }] */
export const pictures = signal([]);
export const kMostPictures = 4;

/** Columns that the open lenses draw. */
export const columnsOfPictures = () => pictures.value.flatMap((config) => {
  const lens = lenses[config.kind];
  return lens.needs(lens.adjust ? lens.adjust(config, variables.value) : config, variables.value);
});

const storageKey = () => `volcal:pictures:${campaign.value?.file}`;
let next = 0;
let untouched = false;
const withKey = (config) => ({ of: 'reading', perSigma: false, ...config, key: (next += 1) });

const positions = () => variables.value.filter(({ kind, name }) => kind === 'position' || ['x', 'y', 'z'].includes(name));
const has = (name) => variables.value.some((variable) => variable.name === name);

function opening() {
  const axes = positions().map(({ name }) => name);
  const directions = directionsOf(variables.value).map(({ name }) => name);
  const first = axes[0] ?? 'row';
  const bar = campaign.value.setups.some((setup) => setup.bar);
  return [
    { kind: 'scatter', x: directions[0] ?? first },
    { kind: 'heat', x: first, y: axes[axes.length - 1] ?? 'row' },
    { kind: 'vectors', split: '' },
    bar ? { kind: 'polar' } : { kind: 'time', x: timeOf(variables.value)?.name ?? 'row' },
  ].map(withKey);
}

/** Variables for a lens that has none yet. */
const sides = () => ({ x: positions()[0]?.name ?? 'row', y: positions().at(-1)?.name ?? 'row' });

const valid = (config) => (!config.x || has(config.x)) && (!config.y || has(config.y));

/** Opens the lenses of this campaign as they were left in this tab. */
export function openPictures() {
  try {
    const kept = JSON.parse(sessionStorage.getItem(storageKey()) ?? 'null');
    if (Array.isArray(kept) && kept.length > 0 && kept.every(valid)) {
      pictures.value = kept.map(withKey);
      return;
    }
  } catch { /* what was kept is of no use */ }
  pictures.value = opening();
  untouched = true;
}

/** What stands out most is looked at first, while nobody has chosen anything. */
export function openOn([first, ...others], of = 'reading') {
  if (!untouched) return;
  const to = (kind, values) => { pictures.value = pictures.value.map((each) => (each.kind === kind ? { ...each, ...values } : each)); };
  if (has(first)) to('scatter', { x: first, of });
  if (others.length > 1 && others.every(has)) to('heat', { x: others[0], y: others[1], of });
}

export function change(key, values) {
  untouched = false;
  pictures.value = pictures.value.map((each) => (each.key === key ? { ...sides(), ...each, ...values } : each));
}
export const close = (key) => { untouched = false; pictures.value = pictures.value.filter((each) => each.key !== key); };

export function open(kind) {
  if (pictures.value.length < kMostPictures) pictures.value = [...pictures.value, withKey({ kind, ...sides() })];
}

/** Sets lenses to the variables in which something stands out: residuals against the first, a map of the first two. */
export function lookAlong(names, of = 'reading') {
  untouched = false;
  const usable = names.filter(has);
  if (usable.length === 0) return;
  const wanted = [{ kind: 'scatter', x: usable[0], of }];
  if (usable.length > 1) wanted.push({ kind: 'heat', x: usable[0], y: usable[1], of });
  if (usable.length > 2) wanted.push({ kind: 'scatter', x: usable[2], of });
  const list = [...pictures.value];
  for (const config of wanted) {
    const at = list.findIndex((each) => each.kind === config.kind && !each.set);
    if (at >= 0) list[at] = { ...list[at], ...config, set: true };
    else if (list.length < kMostPictures) list.push(withKey({ ...config, set: true }));
  }
  pictures.value = list.map(({ set, ...each }) => each);
}

/** Variables that the name of an effect speaks of: "reversal:EXX:dir_x:step" of dir_x. */
export const variablesIn = (effectName) => String(effectName).split(/[^A-Za-z0-9_]+/).filter(has);

/** What of the residuals shows an effect best: beams from several sides feel a shift along X with different signs. */
export function shiftOf({ name = '', label = '', direction = null }) {
  const axis = direction ?? `${name} ${label}`.match(/\bE([XYZ])[XYZABC]\b/)?.[1];
  return /^[XYZ]$/.test(axis ?? '') ? axis.toLowerCase() : 'reading';
}
