// Surfaces and curves of the model, each with its band.
import { note } from '../dom.js';
import { drawSurface } from '../lenses/surface.js';

export function renderSurfaces(body, data) {
  for (const surface of data.surfaces) {
    drawSurface(body, surface, { over: 'the range of its drivers', title: `${surface.label}, as the readings show it` });
  }
  body.append(note('Smooth functions found by the readings alone. Bands are U95; where there are no readings they are as wide as the prior allows. Beyond its range a function fades to zero. What the rest of the model can imitate is not part of it. identified.toml holds the coefficients.'));
}
