// A picture in two layers: what changes with the model below, what changes under the pointer above.
import { effect } from '@preact/signals';
import { onPrint, onThemeChange } from '../../../../report/web/src/theme.js';
import { overlay, view } from '../app/view.js';
import { selection } from '../app/store.js';
import { emptySelection, mark } from '../data/selection.js';
import { alpha, hex, kMarked } from '../draw/palette.js';
import { forget, nextFrame, whenDrawn } from '../draw/schedule.js';
import { abandon, begin, painted } from '../draw/timing.js';
import { lenses } from './registry.js';

const kClick = 4; // pixels: a shorter way of the pointer is a click

const living = new Set();
onThemeChange(() => living.forEach((picture) => picture.redraw()));
// Paper is printed before the next frame.
onPrint(() => living.forEach((picture) => picture.paintNow()));

function prepared(canvas, width, height) {
  const ratio = Math.min(2, globalThis.devicePixelRatio || 1);
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
  const ctx = canvas.getContext('2d');
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, width, height);
  return ctx;
}

export class Picture {
  constructor({ frame, below, above, plot, onReadout, onChange }) {
    Object.assign(this, { frame, below, above, plot, onReadout, onChange, scene: null, drag: null, keys: null });
    this.drawBelow = () => this.paintBelow();
    this.drawAbove = () => this.paintAbove();
    this.observer = new ResizeObserver(() => this.redraw());
    this.observer.observe(frame);
    this.stop = [effect(() => { view.value; this.redraw(); }), effect(() => { overlay.value; nextFrame(this.drawAbove); })];
    this.listen();
    living.add(this);
  }

  end() {
    living.delete(this);
    this.observer.disconnect();
    this.stop.forEach((stop) => stop());
    [this.drawBelow, this.drawAbove].forEach(forget);
    if (this.plotted) Plotly.purge(this.plot);
  }

  show(config) {
    this.config = config;
    this.lens = lenses[config.kind];
    this.changed = true;
    this.redraw();
  }

  redraw() {
    nextFrame(this.drawBelow);
    nextFrame(this.drawAbove);
  }

  paintNow() {
    this.paintBelow();
    this.paintAbove();
  }

  size() { return { width: this.frame.clientWidth, height: this.frame.clientHeight }; }

  paintBelow() {
    const { width, height } = this.size();
    if (!this.config || width < 80 || height < 80) return;
    const ctx = prepared(this.below, width, height);
    this.scene = view.value ? this.lens.prepare(view.value, this.config, { width, height }) : null;
    this.onReadout(this.scene?.empty ?? null);
    if (this.scene && !this.scene.empty) this.lens.drawBase(ctx, this.scene);
    this.drawPlot();
    if (!this.scene || !this.changed) return;
    this.changed = false;
    const [mine, other] = this.config.kind === 'heat' ? ['map', 'variable'] : ['variable', 'map'];
    abandon(other);
    whenDrawn(() => painted(mine));
  }

  /** The part that the plot library draws. */
  drawPlot() {
    const figure = this.lens.library && this.scene?.figure;
    this.plot.hidden = !figure;
    if (!figure || !globalThis.Plotly) return;
    const { data, layout } = figure();
    Plotly.react(this.plot, data, { ...layout, width: this.size().width }, { displayModeBar: false, staticPlot: true });
    this.plotted = true;
  }

  paintAbove() {
    const { width, height } = this.size();
    if (!this.config || width < 80) return;
    const ctx = prepared(this.above, width, height);
    if (!this.scene) return;
    this.lens.drawOverlay(ctx, this.scene, overlay.value);
    const rect = this.drag?.rect ?? this.keys;
    if (!rect) return;
    ctx.fillStyle = alpha(kMarked, 0.1);
    ctx.strokeStyle = hex(kMarked);
    ctx.lineWidth = 1;
    ctx.fillRect(rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0);
    ctx.strokeRect(rect.x0 + 0.5, rect.y0 + 0.5, rect.x1 - rect.x0, rect.y1 - rect.y0);
  }

  at(event) {
    const box = this.above.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  listen() {
    const on = (name, listener) => this.above.addEventListener(name, listener);
    on('pointerdown', (event) => this.down(event));
    on('pointermove', (event) => this.move(event));
    on('pointerup', (event) => this.up(event));
    on('pointercancel', () => { this.drag = null; });
    on('pointerleave', () => { if (!this.drag) this.onReadout(this.scene?.empty ?? null); });
    on('keydown', (event) => this.key(event));
    on('blur', () => { this.keys = null; nextFrame(this.drawAbove); });
  }

  down(event) {
    if (event.button !== 0 || !this.scene) return;
    const [x, y] = this.at(event);
    this.drag = { x, y, turns: this.lens.turns && !event.shiftKey, former: event.shiftKey || event.ctrlKey ? selection.value.mask : null };
    this.above.setPointerCapture(event.pointerId);
  }

  move(event) {
    const [x, y] = this.at(event);
    if (!this.drag) {
      if (this.scene) this.onReadout(this.lens.readout(this.scene, x, y));
      return;
    }
    const { drag } = this;
    if (drag.turns) {
      this.turn((x - drag.x) * 0.01, (y - drag.y) * 0.01);
      Object.assign(drag, { x, y, moved: true });
      return;
    }
    if (Math.hypot(x - drag.x, y - drag.y) < kClick && !drag.rect) return;
    drag.rect = { x0: Math.min(x, drag.x), x1: Math.max(x, drag.x), y0: Math.min(y, drag.y), y1: Math.max(y, drag.y) };
    this.mark(drag.rect, drag.former);
  }

  up(event) {
    const { drag } = this;
    this.drag = null;
    if (!drag) return;
    if (!drag.rect && !drag.moved) this.clicked(...this.at(event));
    nextFrame(this.drawAbove);
  }

  clicked(x, y) {
    const chosen = this.lens.click?.(this.scene, x, y);
    if (chosen) this.onChange(chosen);
    else if (selection.value.mask) selection.value = emptySelection;
  }

  turn(by, tilt) {
    const { turn = -0.6, tilt: former = 0.45 } = this.config;
    this.onChange({ turn: turn + by, tilt: Math.max(-1.5, Math.min(1.5, former + tilt)) });
  }

  mark(rect, former) {
    const inside = this.lens.brush(this.scene, rect);
    if (!inside) return;
    begin('brush');
    selection.value = mark(view.value.length, view.value.shown, inside, former);
    whenDrawn(() => painted('brush'));
    nextFrame(this.drawAbove);
  }

  /** Arrow keys move a window over the picture, with Shift they change its size; it marks what lies in it. */
  key(event) {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (event.key === 'Escape') this.keys = null;
    if (!steps || !this.scene || this.scene.empty || event.ctrlKey || event.altKey) return;
    event.preventDefault();
    const { width, height } = this.size();
    const box = this.lens.brushBox(this.scene) ?? { left: 0, right: width, top: 0, bottom: height };
    const unit = [(box.right - box.left) / 24, (box.bottom - box.top) / 12];
    const rect = this.keys ?? { x0: box.left, x1: box.left + 3 * unit[0], y0: box.top, y1: box.bottom };
    this.keys = event.shiftKey ? resized(rect, steps, unit, box) : moved(rect, steps, unit, box);
    this.mark(this.keys, null);
  }
}

function moved(rect, [dx, dy], unit, box) {
  const [w, h] = [rect.x1 - rect.x0, rect.y1 - rect.y0];
  const x0 = Math.max(box.left, Math.min(box.right - w, rect.x0 + dx * unit[0]));
  const y0 = Math.max(box.top, Math.min(box.bottom - h, rect.y0 + dy * unit[1]));
  return { x0, x1: x0 + w, y0, y1: y0 + h };
}

function resized(rect, [dx, dy], unit, box) {
  const x1 = Math.max(rect.x0 + unit[0], Math.min(box.right, rect.x1 + dx * unit[0]));
  const y1 = Math.max(rect.y0 + unit[1], Math.min(box.bottom, rect.y1 + dy * unit[1]));
  return { ...rect, x1, y1 };
}
