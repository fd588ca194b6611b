// Keys that hold everywhere.
import { emptySelection } from '../data/selection.js';
import { redo, undo } from './actions.js';
import { mayAct, selection } from './store.js';

const isText = (node) => node instanceof HTMLElement && node.matches('input[type=text], input[type=number], textarea');

export function listenToKeys() {
  addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && selection.value.mask) selection.value = emptySelection;
    if (!(event.ctrlKey || event.metaKey) || event.altKey || isText(event.target)) return;
    const key = event.key.toLowerCase();
    const wish = key === 'z' && !event.shiftKey ? undo : (key === 'z' && event.shiftKey) || key === 'y' ? redo : null;
    if (!wish || !mayAct.value) return;
    event.preventDefault();
    wish();
  });
}
