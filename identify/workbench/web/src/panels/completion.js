// Words that could stand at the caret.

/** Text and caret after a word of the list is taken. */
export const taken = (text, at, from, word) => ({ text: text.slice(0, from) + word + text.slice(at), at: from + word.length });

/** The program counts bytes of UTF-8, the page characters. */
export const bytesBefore = (text, at) => new TextEncoder().encode(text.slice(0, at)).length;
export const placeOfByte = (text, byte) => new TextDecoder().decode(new TextEncoder().encode(text).slice(0, byte)).length;
/** Columns count from 1. */
export const columnOfByte = (text, column) => placeOfByte(text, column - 1) + 1;

/** A line that points at a column (from 1) of the text above it. */
export const caretLine = (column) => `${' '.repeat(Math.max(0, column - 1))}^`;
