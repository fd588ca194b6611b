// The error of the rotary axes over their positions: a heat map over two of them, a curve over one.
// axes: [{ name, places, dots }], layer: { name, value, U95 or none, scale of colours where several maps share it, quiet: the largest is not marked }, unit.
import { curve, heatMap } from './surface.js';

const kHeight = 430;

/** One layer of a map as the surface lens takes it. */
export function layerData(axes, layer, unit) {
  const sizes = layer.value.map(Math.abs);
  const k = sizes.indexOf(Math.max(...sizes));
  const inner = axes.at(-1).places.length;
  return {
    axes: axes.map((axis) => ({ ...axis, title: `${axis.name} [°]` })), isSize: layer.value.every((value) => value >= 0), value: layer.value, U95: layer.U95, scale: layer.scale, quiet: layer.quiet, unit, target: layer.name, largest: layer.value[k], largest_U95: layer.U95?.[k],
    at: axes.length === 1 ? [axes[0].places[k]] : [axes[0].places[Math.floor(k / inner)], axes[1].places[k % inner]],
  };
}

export function rotaryMapFigure(axes, layer, unit, height = kHeight) {
  const data = layerData(axes, layer, unit);
  return { paperHeight: 0.55, ...(axes.length === 1 ? curve(data) : heatMap(data, height)) };
}
