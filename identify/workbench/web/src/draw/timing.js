// Time from an input to what it shows on the screen, as entries of the browser: volcal:brush, volcal:hover ...
const begun = new Map();

/** An input has come. */
export function begin(name) {
  if (begun.has(name)) return;
  const now = globalThis.event?.timeStamp;
  begun.set(name, now > 0 && now <= performance.now() ? now : performance.now());
}

/** What the input changes is drawn: the time ends when the picture is on the screen. */
export function painted(name) {
  const start = begun.get(name);
  if (start === undefined) return;
  begun.delete(name);
  requestAnimationFrame(() => {
    const channel = new MessageChannel();
    channel.port1.onmessage = () => {
      performance.measure(`volcal:${name}`, { start, end: performance.now() });
      channel.port1.close();
    };
    channel.port2.postMessage(null);
  });
}

export const abandon = (name) => begun.delete(name);
