// Formulas of the mock program: "EXX += dir_x * (T_column - 20)".
export class FormulaError extends Error {
  constructor(message, remedy, column) { super(message); Object.assign(this, { remedy, column }); }
}

const kFunctions = { sin: Math.sin, cos: Math.cos, exp: Math.exp, abs: Math.abs };
const kTarget = /^\s*E(XX|YY|ZZ)\s*\+=\s*/;

function tokens(text, from) {
  const list = [];
  const pattern = /\s*([A-Za-z_]\w*|\d+\.?\d*|[-+*/()])/y;
  pattern.lastIndex = from;
  while (pattern.lastIndex < text.length && text.slice(pattern.lastIndex).trim() !== '') {
    const at = pattern.lastIndex + text.slice(pattern.lastIndex).match(/^\s*/)[0].length;
    const found = pattern.exec(text);
    if (!found) throw new FormulaError(`"${text[at]}" has no place here`, 'Use names, numbers, + - * / and brackets.', at + 1);
    list.push({ text: found[1], column: at + 1 });
  }
  return list;
}

class Parser {
  constructor(list, names, end) { Object.assign(this, { list, names, end, at: 0 }); }

  peek() { return this.list[this.at]?.text; }
  take() { return this.list[this.at++]; }

  sum() {
    let left = this.product();
    while (this.peek() === '+' || this.peek() === '-') {
      const sign = this.take().text === '+' ? 1 : -1;
      const [a, b] = [left, this.product()];
      left = (c, i) => a(c, i) + sign * b(c, i);
    }
    return left;
  }

  product() {
    let left = this.factor();
    while (this.peek() === '*' || this.peek() === '/') {
      const divide = this.take().text === '/';
      const [a, b] = [left, this.factor()];
      left = divide ? (c, i) => a(c, i) / b(c, i) : (c, i) => a(c, i) * b(c, i);
    }
    return left;
  }

  factor() {
    const token = this.take();
    if (!token) throw new FormulaError('the formula ends too early', 'Write what is multiplied.', this.end + 1);
    if (token.text === '-') { const inner = this.factor(); return (c, i) => -inner(c, i); }
    if (token.text === '(') return this.closed();
    if (/^\d/.test(token.text)) { const value = Number(token.text); return () => value; }
    if (token.text in kFunctions && this.peek() === '(') { this.take(); const inner = this.closed(); return (c, i) => kFunctions[token.text](inner(c, i)); }
    if (this.names.includes(token.text)) return (c, i) => c[token.text][i];
    throw new FormulaError(`no variable is called ${token.text}`, `Known are ${this.names.join(', ')}.`, token.column);
  }

  closed() {
    const inner = this.sum();
    if (this.peek() !== ')') throw new FormulaError('a bracket is not closed', 'Write ).', this.list[this.at]?.column ?? this.end + 1);
    this.take();
    return inner;
  }
}

export function readFormula(text, names) {
  const head = text.match(kTarget);
  if (!head) throw new FormulaError('a formula begins with the error that it adds to', 'Write for instance EXX += dir_x.', 1);
  const parser = new Parser(tokens(text, head[0].length), names, text.length);
  const law = parser.sum();
  if (parser.peek()) throw new FormulaError(`"${parser.peek()}" has no place here`, 'Use + - * / between names.', parser.list[parser.at].column);
  const axis = head[1][0].toLowerCase();
  return { axis, column: (c, i) => c[`along_${axis}`][i] * law(c, i) };
}

export function complete(text, at, names) {
  const begun = text.slice(0, at).match(/[A-Za-z_]\w*$/)?.[0] ?? '';
  const list = [...['EXX', 'EYY', 'EZZ'].map((word) => ({ word, meaning: 'error along its axis' })), ...names.map((word) => ({ word, meaning: 'recorded with the readings' })), ...Object.keys(kFunctions).map((word) => ({ word, meaning: 'function' }))];
  return { from: at - begun.length, words: begun === '' ? [] : list.filter(({ word }) => word.startsWith(begun) && word !== begun).slice(0, 8) };
}
