// Words that could stand at the caret.

/** Text and caret after a word of the list is taken. */
export const taken = (text, at, from, word) => ({ text: text.slice(0, from) + word + text.slice(at), at: from + word.length });

/** A line that points at a column (from 1) of the text above it. */
export const caretLine = (column) => `${' '.repeat(Math.max(0, column - 1))}^`;
