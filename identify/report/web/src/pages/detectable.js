import { bar, choice, el, fixed, longTable, note, significant } from '../dom.js';

const columns = [
  { name: 'Effect', align: 'left', cell: (row) => row.label },
  { name: 'Kind', align: 'left', cell: (row) => row.kind },
  { name: 'Driver', align: 'left', cell: (row) => row.driver },
  { name: 'Shape', align: 'left', cell: (row) => row.shape },
  { name: 'MDB', cell: (row) => (row.visible ? significant(row.mdb, 2) : '–') },
  { name: 'Unit', align: 'left', cell: (row) => row.unit },
  { name: 'In the volume', unit: 'µm RMS', title: 'displacement of the functional point by an effect of that size', cell: (row) => (row.visible ? significant(row.volumetric_um, 2) : '–') },
  { name: 'Visible fraction', align: 'left', cell: (row) => bar(row.visible_fraction, '') },
  { name: '', cell: (row) => fixed(row.visible_fraction, 2) },
  { name: '', align: 'left', cell: (row) => (row.visible ? '' : 'NOT VISIBLE') },
];

export function renderDetectable(body, data) {
  body.append(note(`MDB: the amplitude that is found with 80 % probability at the family-wise threshold, one line per effect of the catalogue that could act here, ${data.when}. In the volume: what an effect of that size, undetected, would move the functional point by over the measured positions (effects on the instrument alone have no figure). ${data.not_visible} of ${data.rows.length} are not visible in these readings: less than 2 % of them survives the projection.`));
  const frame = el('div', {});
  const kinds = [...new Set(data.rows.map((row) => row.kind))];
  let visible = 'all';
  let kind = 'all';
  const redraw = () => {
    const rows = data.rows.filter((row) => (kind === 'all' || row.kind === kind) && (visible === 'all' || row.visible === (visible === 'visible')));
    frame.replaceChildren(longTable(columns, rows, { rowClass: (row) => (row.visible ? null : 'dim'), caption: 'Smallest detectable effects' }));
  };
  const menu = el('select', { 'aria-label': 'Kind', onchange: (event) => { kind = event.target.value; redraw(); } },
    ['all', ...kinds].map((name) => el('option', { value: name }, name === 'all' ? 'all kinds' : name)));
  redraw();
  body.append(el('div', { class: 'controls' }, [
    el('label', { class: 'menu' }, [el('span', { class: 'muted' }, 'Kind'), menu]),
    choice('Show', [['all', 'all'], ['visible', 'visible'], ['not', 'not visible']], (value) => { visible = value; redraw(); }),
  ]), frame);
}
