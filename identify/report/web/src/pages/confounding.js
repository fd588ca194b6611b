import { choice, el, fixed, note, significant, table } from '../dom.js';
import { caption } from '../names.js';
import { color, onThemeChange, shaded } from '../theme.js';

const kLeading = 12; // rows of the short map
const kBesideMap = 14; // rows up to which text stands beside the map; above them in the map's empty corner
const kPrinted = 0.5; // cosine from which on a cell holds a number
const kNear = 0.9;

/** Hypotheses, their cosines and the proposals between them. */
class Hypotheses {
  constructor(data) {
    this.effects = data.effects;
    this.rows = data.cosine;
    this.same = data.same;
    this.proposals = data.proposals;
    this.index = new Map(data.effects.map((effect, k) => [effect.name, k]));
  }

  cosine(a, b) { return this.rows[Math.max(a, b)][Math.min(a, b)]; }

  proposalsFor(a, b) {
    const wanted = [this.effects[a].name, this.effects[b].name];
    return this.proposals.filter((each) => each.separates.length === 2 && each.separates.every((effect) => wanted.includes(effect.name)));
  }

  proposalPairs() {
    return this.proposals.filter((each) => each.separates.length === 2)
      .map((each) => each.separates.map((effect) => this.index.get(effect.name)))
      .filter((pair) => pair.every((k) => k !== undefined));
  }

  pairs() {
    return this.effects.flatMap((_, a) => this.effects.slice(0, a).map((__, b) => [b, a])).filter(([a, b]) => this.cosine(a, b) !== null);
  }

  nearestPair() {
    const proposed = this.proposalPairs();
    const all = proposed.length > 0 ? proposed : this.pairs();
    return all.reduce((best, pair) => (this.cosine(...pair) > this.cosine(...best) ? pair : best), all[0]);
  }
}

const cosineText = (value) => {
  if (value === null) return '';
  const text = fixed(value, 2);
  return text === '1.00' ? (value > 0.9999 ? '1' : '>.99') : text.slice(1);
};

function cell(hypotheses, a, b) {
  const value = hypotheses.cosine(a, b);
  const shade = value === null ? 0 : value ** 4;
  const near = value !== null && value > kNear;
  const classes = [value === null ? 'unseen' : null, hypotheses.proposalsFor(a, b).some((each) => each.helps) ? 'planned' : null];
  return el('td', {
    'data-a': a, 'data-b': b, class: classes.filter(Boolean).join(' ') || null,
    style: value === null ? null : shaded(color(near ? 'bad' : 'heat'), shade),
  }, value === null ? '–' : value >= kPrinted ? cosineText(value) : '');
}

/** Lower triangle; the diagonal numbers the columns. */
function map(hypotheses, rows) {
  return el('table', { class: `heat confounding${rows > 24 ? ' dense' : ''}` }, [caption('Cosines between effects'), el('tbody', {}, hypotheses.effects.slice(0, rows).map((effect, a) => el('tr', { 'data-a': a }, [
    el('th', { scope: 'row', class: `role-${effect.role}`, title: effect.name }, [el('span', { class: 'name' }, effect.label), ' ', el('span', { class: 'number' }, a + 1)]),
    ...hypotheses.effects.slice(0, a).map((_, b) => cell(hypotheses, a, b)),
    el('td', { class: 'own', 'data-b': a }, a + 1),
  ])))]);
}

const limitText = (limit) => {
  const mdb = limit.mdb === null ? 'never found' : `found from ${significant(limit.mdb, 2)} ${limit.unit}`;
  if (limit.mib === null) return limit.rival === '' ? mdb : `${mdb}, not separable from ${limit.rival}`;
  const mib = `named for certain from ${significant(limit.mib, 2)} ${limit.unit}`;
  return `${mdb}, ${mib}${limit.rival === '' ? '' : ` (nearest: ${limit.rival})`}`;
};

/** Components that are all found and not separable from one rival, in one line. */
function commonLimit(limits) {
  const [{ unit, rival }] = limits;
  const common = limits.length > 1 && limits.every((limit) => limit.mdb !== null && limit.mib === null && limit.rival === rival && limit.unit === unit);
  if (!common) return null;
  const mdbs = `found from ${limits.map((limit) => significant(limit.mdb, 2)).join(', ')} ${unit}`;
  return rival === '' ? mdbs : `${mdbs}, not separable from ${rival}`;
}

function limitItems(effect) {
  const limits = effect.limits.slice(0, 3);
  const common = limits.length > 0 ? commonLimit(limits) : null;
  return common === null ? separateItems(effect, limits) : [el('li', {}, [el('strong', {}, effect.label), ': ', common])];
}

const separateItems = (effect, limits) => limits.map((limit) => el('li', {}, [el('strong', {}, effect.limits.length > 1 ? limit.label : effect.label), ': ', limitText(limit)]));

function apartText(cosine, same) {
  if (cosine === null) return 'Nothing of one of the two is visible in these readings.';
  const squaredSine = 1 - cosine * cosine;
  if (squaredSine < same) return 'They predict the same readings: no size tells them apart.';
  const factor = 1 / Math.sqrt(squaredSine);
  if (factor < 1.1) return 'These readings tell the two apart as soon as they show one of them.';
  return `To be separated from the other, an effect must be ${significant(factor, 2)} times as large as to be found.`;
}

function remedy(hypotheses, a, b) {
  const proposals = hypotheses.proposalsFor(a, b);
  if (proposals.length > 0) {
    return el('ul', {}, proposals.map((each) => el('li', {}, each.helps
      ? [el('strong', {}, each.what), ` (${each.readings} readings): ${significant(each.now, 2)} → ${significant(each.reached, 2)} σ apart; as many plain readings: ${significant(each.plain, 2)} σ.`]
      : 'No candidate measurement separates the two.')));
  }
  const asked = [a, b].map((k) => hypotheses.effects[k]);
  if (!asked.every((effect) => effect.can_be_asked)) return el('p', { class: 'muted' }, 'One of the two is a change of the model itself: no measurement is planned for that.');
  return el('p', {}, ['Which measurement would tell them apart: ', el('code', {}, `volcal diagnose … --separate "${asked.map((effect) => effect.name).join(',')}"`)]);
}

function pairDetails(hypotheses, a, b) {
  const value = hypotheses.cosine(a, b);
  const angle = value === null ? null : Math.acos(Math.min(1, value)) * 180 / Math.PI;
  return [
    el('p', { class: 'pair-names' }, [el('strong', {}, hypotheses.effects[a].label), ` (${a + 1}) and `, el('strong', {}, hypotheses.effects[b].label), ` (${b + 1})`]),
    el('p', {}, [value === null ? '' : `Cosine ${fixed(value, 3)}, ${significant(angle, 2)}° apart. `, apartText(value, hypotheses.same)]),
    el('ul', {}, [...limitItems(hypotheses.effects[a]), ...limitItems(hypotheses.effects[b])]),
    remedy(hypotheses, a, b),
  ];
}

/** Pair that is pointed at; a click holds it. */
function follow(frame, details, hypotheses, first) {
  let held = first;
  const mark = ([a, b]) => {
    for (const node of frame.querySelectorAll('.here')) node.classList.remove('here');
    for (const node of frame.querySelectorAll(`[data-a='${a}'] > th, [data-a='${b}'] > th, td[data-a='${a}'][data-b='${b}']`)) node.classList.add('here');
    details.replaceChildren(...pairDetails(hypotheses, b, a));
  };
  const pairAt = (event) => {
    const node = event.target.closest('td[data-a]');
    return node === null ? null : [Number(node.dataset.a), Number(node.dataset.b)];
  };
  frame.addEventListener('mouseover', (event) => mark(pairAt(event) ?? held));
  frame.addEventListener('mouseleave', () => mark(held));
  frame.addEventListener('click', (event) => { held = pairAt(event) ?? held; mark(held); });
  return () => mark(held);
}

const names = (effects) => effects.map((effect) => effect.label).join(', ');

const purpose = (row) => {
  if (row.separates.length === 2) return `tells ${row.separates[0].label} from ${row.separates[1].label}`;
  return `makes visible ${names(row.makes_visible.slice(0, 3))}${row.makes_visible.length > 3 ? ` and ${row.makes_visible.length - 3} more` : ''}`;
};

const times = (value) => (value === null ? 'from nothing' : `${significant(value, 3)} times`);

const worth = (row) => {
  if (!row.helps) return 'they predict nearly the same readings';
  return `${row.readings} readings; information ${times(row.gain)}, by as many plain readings ${times(row.plain_gain)}`;
};

const apart = (row, key) => (row.separates.length === 2 ? significant(row[key], 2) : '–');
const proposalColumns = [
  { name: 'Measurement', align: 'left', cell: (row) => [el('span', {}, row.what), el('span', { class: 'muted block' }, purpose(row)), el('span', { class: 'muted block' }, worth(row))] },
  { name: 'Apart now', unit: 'σ', cell: (row) => apart(row, 'now') },
  { name: 'With it', unit: 'σ', cell: (row) => el('strong', {}, apart(row, 'reached')) },
  { name: 'Plain', unit: 'σ', title: 'with as many further readings of the kind that the campaign has', cell: (row) => apart(row, 'plain') },
];

function proposalTable(data) {
  const body = data.proposals.length > 0
    ? [table(proposalColumns, data.proposals), note('Apart: how far the two predictions stand apart, in standard deviations of the noise, once each may take the best size and all else has been fitted. Information is its square. Plain: with as many further readings of the kind that the campaign has.')]
    : [note('No measurement is proposed: the verdict leaves no alternatives open. --separate asks about any two effects, or how to see one.')];
  return el('div', { class: 'proposals' }, [el('h3', {}, 'What to measure next'), ...body]);
}

const legend = () => el('p', { class: 'legend' }, [
  ['added', 'added to the model'], ['alternative', 'one of the alternatives'], ['candidate', 'other candidates, strongest first'],
].map(([role, text]) => el('span', { class: `key role-${role}` }, [el('i', { class: 'mark' }), text]))
  .concat(el('span', { class: 'key' }, [el('i', { class: 'planned' }), 'a measurement is proposed'])));

export function renderConfounding(body, data) {
  if (data.effects.length < 2) {
    body.append(note('Fewer than two effects are visible in these readings: there is nothing to separate.'), proposalTable(data));
    return;
  }
  const hypotheses = new Hypotheses(data);
  const frame = el('div', { class: 'table-frame' });
  const details = el('div', { class: 'pair-details', 'aria-live': 'polite' });
  const first = hypotheses.nearestPair();
  const holdFirst = first === undefined ? () => {} : follow(frame, details, hypotheses, [Math.max(...first), Math.min(...first)]);
  let rows = data.effects.length;
  const beside = el('div', { class: 'beside' }, [frame, el('div', { class: 'beside-text' }, [details, proposalTable(data)])]);
  const redraw = () => {
    frame.replaceChildren(map(hypotheses, rows));
    beside.classList.toggle('corner', rows > kBesideMap);
    holdFirst();
  };
  body.append(note(`Cosine of the angle between what two effects predict for these readings, after everything the model can already do has been taken away: 1 means that no reading tells them apart. Above ${fixed(kNear, 1)} (red) they are rivals. What was added comes first, then alternatives, then the ranking. Point at a cell.`), legend());
  if (data.effects.length > kLeading) {
    body.append(el('div', { class: 'controls' }, choice('Effects', [[data.effects.length, `all ${data.effects.length}`], [kLeading, `leading ${kLeading}`]], (value) => { rows = value; redraw(); })));
  }
  body.append(beside);
  redraw();
  onThemeChange(redraw);
}
