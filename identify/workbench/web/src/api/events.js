// Server-sent events read with fetch, since EventSource sends no header.
import { headers } from './call.js';
import { eventParser } from './events_text.js';

/** Reads events until the line breaks: resolves with 'refused' or 'broken'. */
async function follow(onOpen, onEvent) {
  let response;
  try {
    response = await fetch('/api/events', { headers: { ...headers(), Accept: 'text/event-stream' }, cache: 'no-store' });
  } catch {
    return 'broken';
  }
  if (!response.ok) return response.status === 403 ? 'refused' : 'broken';
  onOpen();
  const feed = eventParser(onEvent);
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  try {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return 'broken';
      feed(value);
    }
  } catch {
    return 'broken';
  }
}

const kWaits = [300, 600, 1200, 2500, 5000];

/** Keeps a line to the program: onState('open' | 'gone' | 'refused'). Returns a function that tries again at once. */
export function keepLine(onLine, onEvent) {
  let failures = 0;
  let timer = null;
  let connected = false;
  const attempt = async () => {
    clearTimeout(timer);
    if (connected) return;
    connected = true;
    const end = await follow(() => { failures = 0; onLine('open'); }, onEvent);
    connected = false;
    onLine(end === 'refused' ? 'refused' : 'gone');
    if (end !== 'refused') timer = setTimeout(attempt, kWaits[Math.min(failures++, kWaits.length - 1)]);
  };
  attempt();
  return attempt;
}
