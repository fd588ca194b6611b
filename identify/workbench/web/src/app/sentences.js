// Sentences on what has happened.
import { fixed, significant } from '../../../../report/web/src/dom.js';

const modelIn = (state, number) => state.models?.find((model) => model.number === number);

/** Two significant digits of the interval decide the decimals. */
export function micrometres(value, low = null, high = null) {
  const width = low !== null && high !== null && high > low ? (high - low) / 2 : null;
  if (width === null) return significant(value, 3);
  return fixed(value, Math.min(4, Math.max(0, 1 - Math.floor(Math.log10(width)))));
}

/** What the change from one state to the next did to the error, or null. */
export function fallSentence(former, next) {
  const [from, to] = [modelIn(former, former.current), modelIn(next, next.current)];
  if (!from || !to || (from.number === to.number && from.standing === to.standing)) return null;
  const [a, b] = [from.figures?.systematic_um, to.figures?.systematic_um];
  if (!Number.isFinite(a) || !Number.isFinite(b)) return null;
  const about = to.standing === 'preview' || to.standing === 'refitted' ? 'about ' : '';
  const verb = b < a ? 'falls' : b > a ? 'rises' : 'stays';
  return `The systematic error on held-out lines ${verb} from ${significant(a)} to ${about}${significant(b)} micrometres.`;
}

/** "10^-12" of a decimal logarithm. */
export function chance(log10) {
  if (!Number.isFinite(log10)) return '–';
  if (log10 > -3) return significant(10 ** log10, 2);
  const digits = [...String(Math.round(-log10))].map((digit) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[digit]).join('');
  return `10⁻${digits}`;
}

export const seconds = (value) => (value === null || value === undefined ? '' : value < 1.5 ? 'a second left' : value < 90 ? `${Math.round(value)} s left` : `${Math.round(value / 60)} min left`);
