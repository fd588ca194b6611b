// The text of server-sent events.

/** Splits a stream of text into events: feed(text) calls onEvent(name, data) for every whole one. */
export function eventParser(onEvent) {
  let rest = '';
  return (text) => {
    rest = (rest + text).replaceAll('\r\n', '\n');
    for (let end = rest.indexOf('\n\n'); end >= 0; end = rest.indexOf('\n\n')) {
      const lines = rest.slice(0, end).split('\n');
      rest = rest.slice(end + 2);
      const field = (name) => lines.filter((line) => line.startsWith(`${name}:`)).map((line) => line.slice(name.length + 1).trimStart()).join('\n');
      if (field('data') !== '') onEvent(field('event') || 'message', JSON.parse(field('data')));
    }
  };
}
