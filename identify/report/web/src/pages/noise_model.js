import { fixed, note, significant, table } from '../dom.js';

export function renderNoiseModel(body, data) {
  body.append(
    table([
      { name: 'Instrument', align: 'left', cell: (row) => row.instrument },
      { name: 'Term', align: 'left', cell: (row) => row.term },
      { name: '', align: 'left', cell: (row) => row.meaning },
      { name: 'Value', cell: (row) => (row.value === 0 ? 'off' : significant(row.value)) },
      { name: '95 % interval', cell: (row) => (row.low === null || row.value === 0 ? '–' : `${significant(row.low, 2)} … ${significant(row.high, 2)}`) },
      { name: 'Unit', align: 'left', cell: (row) => row.unit },
      { name: 'Likelihood ratio', title: 'twice the log-likelihood that the term gains', cell: (row) => fixed(row.likelihood_ratio, 1) },
      { name: '', align: 'left', cell: (row) => row.remark },
    ], data.rows, { rowClass: (row) => (row.value === 0 ? 'dim' : null) }),
    note(`Restricted maximum likelihood at the model reached, so that slow physics is not taken for noise nor the reverse. Every test and interval of this report uses it. Readings that the outlier test took out: ${data.removed_readings}.`),
  );
}
