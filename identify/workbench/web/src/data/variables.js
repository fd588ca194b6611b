// Variables that the readings were recorded with.
import { distinct } from './statistics.js';

/** Unit of the program's files as it is printed. */
export const unitText = (unit) => String(unit ?? '').replace(/\bum\b/g, 'µm').replace(/\burad\b/g, 'µrad').replace(/([a-zA-Z])([2-9])\b/g, (_, base, power) => base + '²³⁴⁵⁶⁷⁸⁹'[power - 2]).replace(/\bdegC\b/g, '°C').replace(/\bdeg\b/g, '°');
export const titleOf = (variable) => (variable.unit ? `${variable.label} [${unitText(variable.unit)}]` : variable.label);

const isTime = (column) => column.kind === 'time' || /^time(_s)?$/.test(column.name);
const isTemperature = (column) => column.kind === 'temperature' || ['degC', '°C', 'K'].includes(column.unit) || /^T_/.test(column.name);
const isDirection = (column) => column.kind === 'direction' || /^dir_/.test(column.name);

export const timeOf = (columns) => columns.find(isTime) ?? null;
export const temperaturesOf = (columns) => columns.filter(isTemperature);
export const directionsOf = (columns) => columns.filter(isDirection);

/** Variables that every campaign has, besides the columns of its files. */
const kAlways = [
  { name: 'setup', label: 'set-up', unit: '', kind: 'index' },
  { name: 'point_x', label: 'functional point X', unit: 'mm', kind: 'point' },
  { name: 'point_y', label: 'functional point Y', unit: 'mm', kind: 'point' },
  { name: 'point_z', label: 'functional point Z', unit: 'mm', kind: 'point' },
  { name: 'row', label: 'order of the readings', unit: '', kind: 'index' },
];

export function variablesOf(campaign) {
  const own = campaign.columns ?? [];
  const names = new Set(own.map((column) => column.name));
  const always = kAlways.filter((variable) => !names.has(variable.name))
    .map((variable) => (variable.name === 'setup' ? { ...variable, values: campaign.setups.map((setup) => setup.name) } : variable));
  return [...own, ...always];
}

const kMostDistinct = 6;

/** Ticks of a variable that takes a few values only: { at: [value], text: [word] }; null for a continuous one. */
export function stepsOf(variable, values) {
  if (isDirection(variable)) {
    const at = distinct(values, 3) ?? [-1, 0, 1];
    const words = { '-1': 'towards −', 0: 'no direction', 1: 'towards +' };
    return { at, text: at.map((value) => words[value] ?? String(value)) };
  }
  if (variable.values) {
    const at = variable.values.map((_, k) => k);
    return { at, text: variable.values };
  }
  const at = variable.kind === 'position' || variable.kind === 'point' ? null : distinct(values, kMostDistinct);
  return at && at.length > 0 ? { at, text: at.map(String) } : null;
}

/** Sentence on the direction from which the marked readings were approached. */
export function directionWords(variable, value) {
  const axis = variable.name.replace(/^dir_/, '').toUpperCase();
  return value === 0 ? `none with a direction of ${axis}` : `all with ${axis} coming ${value > 0 ? 'towards +' : 'towards −'}`;
}
