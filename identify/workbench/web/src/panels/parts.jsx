// Small parts that several panels have.
import { useEffect, useRef } from 'preact/hooks';
import { decimalsFor, fixed, significant } from '../../../../report/web/src/dom.js';
import { onThemeChange } from '../../../../report/web/src/theme.js';
import { printed } from '../../../../report/web/src/words.js';
import { unitText } from '../data/variables.js';

/** Text of the program as it is printed. */
export const words = (text) => printed(String(text ?? ''));

/** Null stands for what the readings do not determine. */
export const amplitudeText = ({ value, u95, unit }) => (Number.isFinite(value) && Number.isFinite(u95) ? `${fixed(value, decimalsFor(u95))} ± ${significant(u95, 2)} ${unitText(unit)}` : 'not determined');

/** What distinguishes one of several amplitudes. */
export const partOf = (effect, amplitude) => (effect.amplitudes.length > 1 ? String(amplitude.label).replace(effect.label, '').trim() : '');

/** How many of the smallest detectable amplitude it is. */
export const timesDetectable = ({ value, detectable }) => (detectable > 0 && Number.isFinite(value) ? Math.abs(value) / detectable : null);

const kScale = 10; // times the smallest detectable amplitude: the length of the bar

/** A bar in units of the smallest detectable amplitude, with its uncertainty. */
export function AmplitudeBar({ amplitude, preview = false }) {
  const times = timesDetectable(amplitude);
  if (times === null) return null;
  const u = amplitude.u95 / amplitude.detectable;
  const x = (value) => 200 * Math.min(1, Math.max(0, value / kScale));
  return (
    <svg class={`amplitude ${preview ? 'is-preview' : ''}`} viewBox="0 0 204 16" width="140" height="11" aria-hidden="true">
      <rect class="track" x="0" y="4" width="200" height="8" />
      <rect class={times >= 1 ? 'fill' : 'fill small'} x="0" y="4" width={x(times)} height="8" />
      <line class="limit" x1={x(1)} x2={x(1)} y1="0" y2="16" />
      <line class="whisker" x1={x(times - u)} x2={x(times + u)} y1="8" y2="8" />
      {times > kScale && <path class="more" d="M196 3 l6 5 l-6 5" />}
    </svg>
  );
}

/** Shape over its driver, [[driver, value], ...]. */
export function Sketch({ points, label }) {
  if (!points || points.length < 2) return <svg class="sketch" width="72" height="36" aria-hidden="true" />;
  const side = (k) => points.map((point) => point[k]);
  const [xs, ys] = [side(0), side(1)];
  const scale = (list, from, to) => {
    const [low, high] = [Math.min(...list), Math.max(...list)];
    return (v) => from + ((v - low) / (high - low || 1)) * (to - from);
  };
  const [x, y] = [scale(xs, 3, 69), scale([...ys, 0], 33, 3)];
  return (
    <svg class="sketch" viewBox="0 0 72 36" width="72" height="36" role="img" aria-label={`Shape of ${label}`}>
      <line x1="0" x2="72" y1={y(0)} y2={y(0)} class="zero" />
      <polyline points={points.map(([u, v]) => `${x(u).toFixed(1)},${y(v).toFixed(1)}`).join(' ')} />
    </svg>
  );
}

/** A drawing of the plot library, shared with the reports. */
export function Drawing({ make, label }) {
  const node = useRef();
  useEffect(() => {
    const draw = () => {
      if (!globalThis.Plotly || !node.current) return;
      const { data, layout } = make();
      Plotly.react(node.current, data, { ...layout, width: node.current.clientWidth }, { displayModeBar: false, responsive: false });
    };
    draw();
    const stop = onThemeChange(draw);
    const observer = new ResizeObserver(draw);
    observer.observe(node.current);
    return () => {
      observer.disconnect();
      stop();
      if (globalThis.Plotly && node.current) Plotly.purge(node.current);
    };
  }, [make]);
  return <div class="plot" ref={node} role="img" aria-label={label} />;
}

export const Unit = ({ children }) => <span class="unit">{children}</span>;
