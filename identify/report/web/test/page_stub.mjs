// As much of a browser as the page's code asks for, without a picture. It refuses what a reader would see as a
// mistake: texts with "undefined" or "NaN", numbers in plots that are not finite, markup in plots that is not
// the report's own.

// A figure of a standard may be undefined in words; a value never.
const wrong = /(?<! are )undefined|NaN|\[object|Infinity/;
const ownMarkup = /<\/?(b|br|extra)>/g;

function checkText(text) {
  if (wrong.test(text)) throw new Error(`shows "${text}"`);
}

/** Everything that a plot is given, at any depth. */
function checkPlot(value, path) {
  if (value === undefined || value === null || typeof value === 'boolean') return;
  if (typeof value === 'number') {
    if (!Number.isFinite(value)) throw new Error(`${path} is ${value}`);
  } else if (typeof value === 'string') {
    if (wrong.test(value)) throw new Error(`${path} is "${value}"`);
    if (value.replace(ownMarkup, '').replaceAll('<\u200b', '').includes('<')) throw new Error(`${path} has foreign markup: "${value}"`);
  } else {
    for (const [key, each] of Object.entries(value)) checkPlot(each, `${path}.${key}`);
  }
}

const camel = (name) => name.replace(/-(\w)/g, (_, letter) => letter.toUpperCase());

class ClassList {
  constructor(node) { this.node = node; }
  names() { return (this.node.getAttribute('class') ?? '').split(' ').filter(Boolean); }
  contains(name) { return this.names().includes(name); }
  set(names) { this.node.setAttribute('class', names.join(' ')); }
  add(name) { if (!this.contains(name)) this.set([...this.names(), name]); }
  remove(name) { this.set(this.names().filter((each) => each !== name)); }
  toggle(name, on = !this.contains(name)) { on ? this.add(name) : this.remove(name); }
}

/** "td[data-a='1'].here" of one element. */
function matchesOne(node, selector) {
  const tag = selector.match(/^[a-z][a-z0-9]*/)?.[0];
  if (tag && node.tag !== tag) return false;
  const classes = [...selector.matchAll(/\.([\w-]+)/g)].every(([, name]) => node.classList.contains(name));
  return classes && [...selector.matchAll(/\[([\w-]+)(?:='([^']*)')?\]/g)].every(([, name, value]) =>
    node.attributes.has(name) && (value === undefined || node.getAttribute(name) === value));
}

const matches = (node, selector) => selector.split(',').some((one) => {
  const steps = one.trim().split(/\s*>\s*/);
  for (let at = node; steps.length > 0; at = at.parent) {
    if (!at || !matchesOne(at, steps.pop())) return false;
  }
  return true;
});

class Element {
  constructor(tag) {
    this.tag = tag;
    this.attributes = new Map();
    this.children = [];
    this.listeners = {};
    this.dataset = {};
    this.classList = new ClassList(this);
    this.clientWidth = 600;
  }

  get id() { return this.getAttribute('id'); }
  style = {};
  get textContent() { return this.children.map((child) => child.textContent ?? child).join(''); }
  set textContent(text) { this.replaceChildren(text); }

  setAttribute(name, value) {
    checkText(String(value));
    this.attributes.set(name, String(value));
    if (name.startsWith('data-')) this.dataset[camel(name.slice(5))] = String(value);
  }
  getAttribute(name) { return this.attributes.get(name) ?? null; }
  removeAttribute(name) { this.attributes.delete(name); }

  append(...children) {
    for (const child of children) {
      if (child instanceof Element) child.parent = this;
      else if (typeof child === 'string' || typeof child === 'number') checkText(String(child));
      else throw new Error(`a ${this.tag} is given ${child} to hold`);
      this.children.push(child instanceof Element ? child : String(child));
    }
  }
  prepend(child) {
    child.parent = this;
    this.children.unshift(child);
  }
  replaceChildren(...children) {
    this.children = [];
    this.append(...children);
  }

  addEventListener(name, listener) { (this.listeners[name] ??= []).push(listener); }
  dispatch(name, target = this) {
    for (let at = this; at; at = at.parent) at.listeners[name]?.forEach((listener) => listener({ target }));
  }
  on(name, listener) { this.addEventListener(name, listener); }

  descendants() { return this.children.filter((child) => child instanceof Element).flatMap((child) => [child, ...child.descendants()]); }
  querySelectorAll(selector) { return this.descendants().filter((node) => matches(node, selector)); }
  /** A canvas of which nothing is seen. */
  getContext() { return { createImageData: (w, h) => ({ data: new Uint8ClampedArray(4 * w * h) }), putImageData: () => {} }; }
  toDataURL() { return 'data:,'; }
  closest(selector) { return matches(this, selector) ? this : this.parent?.closest(selector) ?? null; }
  getBoundingClientRect() { return { top: 0 }; }
}

/** Page with `json` in it; what the page's code does to it can be read from the elements returned. */
export function openPage(json) {
  const byId = Object.fromEntries(['volcal-data', 'sections', 'pages'].map((id) => [id, new Element('div')]));
  const data = { textContent: json };
  const system = new Element('media');
  const page = new Element('html');
  const plots = [];
  const draw = (node, plotData, layout) => {
    checkPlot({ data: plotData, layout }, 'plot');
    Object.assign(node, { layout });
  };
  Object.assign(globalThis, {
    document: { documentElement: page, createElement: (tag) => new Element(tag), getElementById: (id) => (id === 'volcal-data' ? data : byId[id]) },
    matchMedia: () => Object.assign(system, { matches: false }),
    getComputedStyle: () => ({ getPropertyValue: () => ' #336699' }),
    addEventListener: (name, listener) => page.addEventListener(name, listener),
    IntersectionObserver: class {
      constructor(callback) { this.callback = callback; }
      observe(target) { this.callback([{ isIntersecting: true, target }]); }
      unobserve() {}
    },
    Plotly: {
      newPlot: async (node, plotData, layout) => { plots.push(node); draw(node, plotData, layout); },
      react: draw,
      relayout: () => {},
      purge: () => {},
      Plots: { resize: () => {} },
    },
  });
  return { page, sections: byId.sections, pages: byId.pages, plots };
}
