// Framed columns: length of a JSON text, the text, then float32 columns one behind the other.

/** { head, columns: { name: Float32Array } } of the bytes of an answer. */
export function readFrame(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const begin = Math.ceil((4 + length) / 4) * 4;
  const names = head.columns ?? [];
  const each = names.length > 0 ? Math.floor((buffer.byteLength - begin) / 4 / names.length) : 0;
  return { head, columns: Object.fromEntries(names.map((name, k) => [name, new Float32Array(buffer, begin + 4 * each * k, each)])) };
}

/** The bytes of an answer, for those who answer. */
export function writeFrame(head, columns) {
  const json = new TextEncoder().encode(JSON.stringify({ ...head, columns: Object.keys(columns) }));
  const begin = Math.ceil((4 + json.length) / 4) * 4;
  const arrays = Object.values(columns);
  const bytes = new Uint8Array(begin + 4 * arrays.reduce((sum, array) => sum + array.length, 0)).fill(32, 0, begin);
  new DataView(bytes.buffer).setUint32(0, json.length, true);
  bytes.set(json, 4);
  let at = begin;
  for (const array of arrays) {
    bytes.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), at);
    at += array.byteLength;
  }
  return bytes;
}
