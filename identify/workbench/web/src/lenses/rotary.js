// Rotary axes as the reports draw them: an error motion, an axis line, the error over the positions. They show the model
// of the last full fit, not readings, so that nothing is marked in them.
import { alongFigure } from '../../../../report/web/src/lenses/axis_lines.js';
import { motionCaption, motionFigure } from '../../../../report/web/src/lenses/motion.js';
import { rotaryMapFigure } from '../../../../report/web/src/lenses/rotary_map.js';

/** Whether a campaign records positions of rotary axes. */
export const hasRotaryAxes = (variables) => variables.some(({ name, kind }) => kind === 'position' && ['a', 'b', 'c'].includes(name));

/** Layers of a map: [[place in the map, name, unit], ...]. */
const layersOf = (map) => [['position', 'µm'], ['orientation', 'µrad']].flatMap(([part, unit]) => map[part].map((layer) => ({ ...layer, unit, key: `${part} ${layer.name}` })));

const chosen = (list, wanted, keyOf) => list.find((each) => keyOf(each) === wanted) ?? list[0];

export const motionOptions = ({ rotary }) => (rotary?.motions ?? []).map(({ symbol, meaning }) => [symbol, `${symbol}, ${meaning}`]);
export const lineOptions = ({ rotary }) => (rotary?.lines ?? []).map(({ axis }) => [axis, axis]);
export const toolOptions = ({ rotary }) => (rotary?.maps ?? []).map(({ tool }) => [tool, tool]);
export const layerOptions = ({ rotary }) => (rotary ? layersOf(rotary.maps[0]).map(({ key, name, unit }) => [key, `${name} [${unit}]`]) : []);

/** A lens that draws `figure(rotary, config, height)`; null: there is nothing of its kind. */
function rotaryLens(kind, title, controls, words, figure) {
  const prepare = (view, config, size) => {
    if (config.rotary === undefined) return null;
    const drawn = config.rotary ? figure(config.rotary, config, size.height) : null;
    return drawn ? { figure: () => drawn, words } : { empty: 'The model has no such errors of rotary axes.' };
  };
  return {
    kind, title, controls, asks: 'rotary', library: true, ofRotaryAxes: true, needs: () => [], prepare, drawBase: () => {}, drawOverlay: () => {}, brush: () => null, brushBox: () => null,
    readout: (scene) => scene.empty ?? scene.words,
  };
}

export const motion = rotaryLens('motion', 'error motion', ['motion'], 'The last full fit with its 95 % band, outwards positive.', (rotary, config, height) => {
  const data = chosen(rotary.motions, config.motion, ({ symbol }) => symbol);
  return data ? motionFigure(data, height, `${data.symbol}, ${motionCaption(data)}`) : null;
});

export const axisLine = rotaryLens('axis-line', 'axis line', ['line'], 'The axis line of the last full fit, seen along the axis; the cross is the nominal line.', (rotary, config, height) => {
  const line = chosen(rotary.lines, config.line, ({ axis }) => axis);
  return line ? alongFigure(line, height) : null;
});

export const rotaryMap = rotaryLens('rotary-map', 'error over rotary axes', ['layer', 'tool'], 'Errors of the rotary axes in the last full fit; the tool point stays at one place of the workpiece.', (rotary, config, height) => {
  const map = chosen(rotary.maps, config.tool, ({ tool }) => tool);
  const layer = chosen(layersOf(map), config.layer, ({ key }) => key);
  return rotaryMapFigure(rotary.map_axes, layer, layer.unit, height);
});
