import { el, note, symbolMark } from '../dom.js';

function invisibleList(errors) {
  if (errors.length === 0) return null;
  return el('div', { class: 'invisible' }, [
    el('h3', {}, 'Not visible in these readings'),
    el('dl', {}, errors.flatMap((error) => [
      el('dt', {}, symbolMark(error.symbol, error.symbol.at(-1))),
      el('dd', {}, [error.reason, error.remedy ? el('span', { class: 'remedy' }, error.remedy) : null]),
    ])),
  ]);
}

export const figure = ({ label, value, unit, note: remark }) =>
  el('div', { class: 'figure' }, [
    el('div', { class: 'label' }, label),
    el('div', { class: 'value' }, [value, unit ? el('span', { class: 'unit' }, ` ${unit}`) : null]),
    el('div', { class: 'muted' }, remark),
  ]);

export function renderSummary(body, data) {
  body.append(
    el('div', { class: `status ${data.level}`, 'data-status': data.status }, [
      el('strong', {}, data.headline),
      el('p', {}, data.meaning),
    ]),
    el('div', { class: 'figures' }, data.figures.map(figure)),
  );
  const invisible = invisibleList(data.invisible);
  if (invisible) body.append(invisible);
  if (data.messages.length > 0) {
    body.append(el('h3', {}, 'Messages'), el('ul', { class: 'messages' }, data.messages.map((text) => el('li', {}, text))));
  }
  body.append(
    el('table', { class: 'facts' }, el('tbody', {}, data.facts.map(([name, value]) =>
      el('tr', {}, [el('th', { scope: 'row' }, name), el('td', {}, name === 'Command' ? value : value.replace(/(^|\s)-(?=\d)/g, '$1−'))])))),
    note('Volumetric error: position of the functional point, actual minus nominal without its best rigid motion, at places all over the work volume from both directions of approach, for the tool with the largest error; largest uncertainty: of the places drawn below. Compensation is its negative.'),
  );
}
