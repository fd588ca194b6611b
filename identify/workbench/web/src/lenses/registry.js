// Every lens, by its kind.
import { heat } from './heat.js';
import { histogramLens } from './histogram.js';
import { periodogram } from './periodogram.js';
import { polar } from './polar.js';
import { axisLine, motion, rotaryMap } from './rotary.js';
import { scatter, timeLine } from './scatter.js';
import { vectors } from './vectors.js';

export const lenses = Object.fromEntries([scatter, heat, vectors, polar, periodogram, timeLine, histogramLens, motion, axisLine, rotaryMap].map((lens) => [lens.kind, lens]));
