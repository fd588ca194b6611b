// Requests to the program.
import { readFrame } from './frames.js';

const token = location.hash.slice(1);
export const tab = Array.from(crypto.getRandomValues(new Uint32Array(2)), (n) => n.toString(36)).join('');

/** What the program refuses: what is wrong, what to do, and the column where it stands in a text. */
export class Refusal extends Error {
  constructor(status, { error, remedy = null, column = null }) {
    super(error);
    Object.assign(this, { status, remedy, column });
  }
}

/** The program does not answer. */
export class NoAnswer extends Error {}

export const headers = () => ({ 'X-Volcal-Token': token, 'X-Volcal-Tab': tab });

async function refusal(response) {
  const body = await response.json().catch(() => ({ error: `the program answers ${response.status}` }));
  return new Refusal(response.status, body);
}

async function send(name, body, signal) {
  try {
    return await fetch(`/api/${name}`, { method: 'POST', headers: { ...headers(), 'Content-Type': 'application/json' }, body: JSON.stringify(body), signal });
  } catch (error) {
    if (error.name === 'AbortError') throw error;
    throw new NoAnswer('The program does not answer.');
  }
}

/** Answer to `POST /api/NAME`: JSON, or { head, columns } where columns are sent. */
export async function call(name, body = {}, { signal } = {}) {
  const response = await send(name, body, signal);
  if (!response.ok) throw await refusal(response);
  const framed = (response.headers.get('Content-Type') ?? '').includes('octet-stream');
  return framed ? readFrame(await response.arrayBuffer()) : response.json();
}

/** Only the latest of several questions is asked on: one that is replaced is cancelled and answered with undefined. */
export function latest() {
  let running = null;
  const ask = async (name, body) => {
    running?.abort();
    const mine = new AbortController();
    running = mine;
    try {
      const answer = await call(name, body, { signal: mine.signal });
      return running === mine ? answer : undefined;
    } catch (error) {
      if (error.name === 'AbortError' || running !== mine) return undefined;
      throw error;
    }
  };
  ask.cancel = () => running?.abort();
  return ask;
}
