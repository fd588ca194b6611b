import { choice, el, fixed, note } from '../dom.js';
import { caption } from '../names.js';
import { color, onThemeChange, shaded } from '../theme.js';

const kSaturated = 30; // −log10 p of the strongest shade

class MapView {
  constructor(data) {
    this.data = data;
    this.model = 'given';
    const strongest = (direction) => Math.min(...direction.given.flat());
    this.direction = data.directions.reduce((best, each) => (strongest(each) < strongest(best) ? each : best));
  }

  value(a, b) { return this.direction[this.model][Math.max(a, b)][Math.min(a, b)]; }
}

function cell(view, a, b) {
  const { variables, threshold } = view.data;
  const value = view.value(a, b);
  const shade = Math.min(1, -value / kSaturated);
  const above = value < threshold;
  const title = `${variables[a]}${a === b ? '' : ` and ${variables[b]}`}, along ${view.direction.name}: log10 p ${fixed(value, 1)}${above ? ', above the noise' : ''}`;
  return el('td', {
    title, class: above ? 'above' : null, style: shaded(color(above ? 'bad' : 'heat'), above ? 0.25 + 0.75 * shade : shade),
  }, value < -1 ? fixed(-value, 0) : '');
}

function map(view) {
  const { variables } = view.data;
  return el('table', { class: 'heat generic' }, [
    caption('Tests of variables and of their pairs'),
    el('thead', {}, el('tr', {}, [el('td'), ...variables.map((name) => el('th', { scope: 'col' }, el('span', {}, name)))])),
    el('tbody', {}, variables.map((name, a) => el('tr', {}, [
      el('th', { scope: 'row' }, name),
      ...variables.map((_, b) => (b > a ? el('td', { class: 'empty' }) : cell(view, a, b))),
    ]))),
  ]);
}

export function renderGenericMap(body, data) {
  if (data.variables.length === 0 || data.directions.length === 0) {
    body.append(note('Nothing recorded varies in these readings: there is nothing to scan.'));
    return;
  }
  const view = new MapView(data);
  const frame = el('div', { class: 'table-frame' });
  const redraw = () => frame.replaceChildren(map(view));
  const order = [view.direction, ...data.directions.filter((each) => each !== view.direction)];
  const controls = el('div', { class: 'controls' }, choice('Along', order.map((each) => [each.name, each.name === 'beam' ? 'the beam' : each.name]), (name) => {
    view.direction = data.directions.find((each) => each.name === name);
    redraw();
  }));
  if (data.two_models) {
    controls.append(choice('Model', [['given', 'given'], ['reached', 'reached']], (value) => { view.model = value; redraw(); }));
  }
  redraw();
  onThemeChange(redraw);
  body.append(
    note(`Does anything recorded move the residuals, in whatever way? −log10 p of ${data.tests} tests (polynomials and sums of cosines; the stronger is shown), for one variable on the diagonal and for pairs below it, counted over all tests. Red: above the noise, −log10 p > ${fixed(-data.threshold, 1)}.`),
    controls,
    frame,
  );
}
