import { fixed, significant, table } from './dom.js';
import { instrumentMark } from './theme.js';

/** Terms of a noise model: value, interval and evidence, those that are off in a lighter tone. */
export function noiseTable(rows) {
  return table([
    { name: 'Instrument', align: 'left', cell: (row) => instrumentMark(row.instrument) },
    { name: 'Term', align: 'left', cell: (row) => row.term },
    { name: '', align: 'left', cell: (row) => row.meaning.replace('sigma', 'σ') },
    { name: 'Value', cell: (row) => (row.value === 0 ? 'off' : significant(row.value)) },
    { name: '95 % interval', cell: (row) => (row.low === null || row.value === 0 ? '–' : `${significant(row.low, 2)} … ${significant(row.high, 2)}`) },
    { name: 'Unit', align: 'left', cell: (row) => row.unit },
    { name: 'Likelihood ratio', title: 'twice the log-likelihood that the term gains', cell: (row) => fixed(row.likelihood_ratio, 1) },
    { name: '', align: 'left', cell: (row) => row.remark },
  ], rows, { rowClass: (row) => (row.value === 0 ? 'dim' : null) });
}
