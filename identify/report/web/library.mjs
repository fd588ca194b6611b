// The plot library as the report holds it: it can send a plot nowhere, and names no address but namespaces of XML.

const kNamespaces = 'www.w3.org/';

/** Index behind the brace that closes the one at `open`. Braces inside texts of the library are in pairs. */
function blockEnd(text, open) {
  for (let at = open, depth = 0; at < text.length; ++at) {
    if (text[at] === '{') ++depth;
    if (text[at] === '}' && --depth === 0) return at + 1;
  }
  throw new Error('the plot library has a block without end');
}

function only(text, mark) {
  const at = text.indexOf(mark);
  if (at < 0 || text.indexOf(mark, at + 1) >= 0) throw new Error(`the plot library was expected to hold ${mark} once: look at library.mjs`);
  return at;
}

/** Empties the block that opens first behind `mark`. */
function emptied(text, mark) {
  const open = text.indexOf('{', only(text, mark));
  return `${text.slice(0, open)}{}${text.slice(blockEnd(text, open))}`;
}

/** Takes the whole assignment `owner.mark{...};` away. */
function removed(text, mark) {
  const at = only(text, mark);
  const begin = at - text.slice(0, at).match(/[\w$]*$/)[0].length;
  return text.slice(0, begin) + text.slice(blockEnd(text, at)).replace(/^;/, '');
}

/** Empties the module that holds `mark`. */
function withoutModule(text, mark) {
  const open = text.lastIndexOf('=>{"use strict";', only(text, mark)) + '=>'.length;
  return `${text.slice(0, open)}{}${text.slice(blockEnd(text, open))}`;
}

/** Every address without its scheme, so that credits of licences stay and nothing can be opened. */
export const withoutAddresses = (text) => text.replace(/https?:\/\/([\w.-]+\/?)/g, (address, host) => (host.startsWith(kNamespaces) ? address : host));

/** Addresses in a text that are not namespaces. */
export const addressesIn = (text) => [...text.matchAll(/\b(?:https?|wss?):\/\/[^\s"'`<>)\\]+/g)].map(([address]) => address).filter((address) => !address.includes(`//${kNamespaces}`));

export function offline(library) {
  let text = library;
  text = removed(text, '.sendChartToCloud=');
  text = emptied(text, '.sendDataToCloud=');
  text = emptied(text, '.getLogo=');
  text = withoutModule(text, 'DIALOG_TITLE:');
  text = withoutModule(text, '"plotly-cloud-dialog-box"');
  text = text.replace(/"X \.plotly-cloud[^"]*":(?:"[^"]*"|'[^']*'),/g, '').replace(/cloudupload:\{[^}]*\},/, '');
  text = text.replace(/showSendToCloud:\{valType:"boolean",dflt:!0\}/, 'showSendToCloud:{valType:"boolean",dflt:!1}');
  text = text.replace(/(plotlyServerURL|topojsonURL):\{([^}]*?)dflt:"[^"]*"\}/g, '$1:{$2dflt:""}');
  text = text.replace(/\bwindow\.open\("https?:[^"]*"\)/g, 'void 0');
  text = withoutAddresses(text);
  const left = text.match(/[^"'\n]{0,40}(?:plotly-cloud|Plotly Cloud|cloud\.plotly|cloudupload)[^"'\n]{0,40}/);
  if (left) throw new Error(`the plot library still speaks of its cloud: ${left[0]}`);
  return text;
}
