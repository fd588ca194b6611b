import { note } from '../dom.js';
import { noiseTable } from '../noise_table.js';

export function renderNoiseModel(body, data) {
  body.append(
    noiseTable(data.rows),
    note(`Restricted maximum likelihood at the model reached, so that slow physics is not taken for noise nor the reverse. Every test and interval of this report uses it. Readings that the outlier test took out: ${data.removed_readings}.`),
  );
}
