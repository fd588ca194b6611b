import { el } from '../dom.js';
import { renderSurface } from '../lenses/surface.js';
import { printed } from '../words.js';
import { renderAddedVariable } from './added_variable.js';

/** A section that is pictured alone: the page shows nothing else. */
export function renderPicture(body, data) {
  document.documentElement.classList.add('pictured');
  body.append(el('p', {}, el('strong', {}, printed(data.words))));
  if (data.surface) renderSurface(body, data.surface);
  else renderAddedVariable(body, data.added_variable);
}
