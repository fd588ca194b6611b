// Names for those who do not see the page: captions of tables, labels of plots and of frames that scroll.
import { el } from './dom.js';

/** Names every table, plot and frame of a section that has no name of its own after the heading or caption before it. */
export function nameParts(body, title) {
  let heading = title;
  const seen = new Map();
  const unique = (name) => {
    const times = (seen.get(name) ?? 0) + 1;
    seen.set(name, times);
    return times === 1 ? name : `${name}, ${times}`;
  };
  for (const node of body.querySelectorAll('h3, figcaption, table, .plot')) {
    if (node.classList.contains('plot')) {
      node.setAttribute('role', 'group');
      node.setAttribute('aria-label', unique(`Plot: ${heading}`));
    } else if (node.querySelectorAll('thead, tbody').length > 0) {
      if (node.querySelectorAll('caption').length === 0) node.prepend(caption(unique(heading)));
    } else if (node.textContent.trim() !== '') {
      heading = node.textContent.trim();
    }
  }
}

export const caption = (text) => el('caption', { class: 'hidden' }, text);

/** A frame that scrolls can be reached and scrolled with the keyboard; one that does not is no stop on the way. */
export function watchFrames(main) {
  const check = () => main.querySelectorAll('.table-frame').forEach((frame) => {
    const scrolls = frame.scrollWidth > frame.clientWidth + 1 || frame.scrollHeight > frame.clientHeight + 1;
    const name = frame.querySelectorAll('caption')[0]?.textContent;
    if (scrolls && name) {
      frame.setAttribute('tabindex', '0');
      frame.setAttribute('role', 'region');
      frame.setAttribute('aria-label', `Table: ${name}`);
    } else {
      for (const attribute of ['tabindex', 'role', 'aria-label']) frame.removeAttribute(attribute);
    }
  });
  addEventListener('resize', check);
  main.addEventListener('change', check);
  main.addEventListener('click', check);
  check();
}
