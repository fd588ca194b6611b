import { count, el, fixed, note, significant, table } from '../dom.js';

export function renderComputation(body, data) {
  const total = data.timings.reduce((sum, timing) => sum + timing.seconds, 0);
  body.append(
    el('div', { class: 'columns' }, [
      el('div', {}, [
        el('h3', {}, 'Adjustment'),
        el('table', { class: 'facts' }, el('tbody', {}, [
          ['Observations', count(data.observations)],
          ['Parameters', `${count(data.parameters)}, of which ${count(data.function_parameters)} of error functions`],
          ['Iterations', `${data.iterations}`],
          ['Cost, start to end', `${significant(data.initial_cost, 4)} to ${significant(data.final_cost, 4)}`],
        ].map(([name, value]) => el('tr', {}, [el('th', { scope: 'row' }, name), el('td', {}, value)])))),
      ]),
      el('div', {}, [
        el('h3', {}, 'Time'),
        table([
          { name: 'Stage', align: 'left', cell: (row) => row.stage },
          { name: 'Time', unit: 's', cell: (row) => fixed(row.seconds, 3) },
        ], [...data.timings, { stage: 'total', seconds: total }]),
      ]),
    ]),
    el('h3', {}, 'Symbols'),
    el('dl', { class: 'glossary' }, data.glossary.flatMap(([symbol, meaning]) => [el('dt', {}, symbol), el('dd', {}, meaning)])),
    note('Positions and points in mm in machine coordinates with all axes at 0; volumetric errors in workpiece coordinates.'),
  );
}
