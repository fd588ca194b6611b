// What the pictures are drawn from: residuals now, before and with what is looked at, and which readings are shown.
import { computed } from '@preact/signals';
import { arrived, column, linesOfReadings } from './columns.js';
import { beforeModel, campaign, currentModel, preview, selection, shown, variables } from './store.js';

/** Units of every set-up's channels: 'um' or 'urad'. */
const unitsOf = (given) => given.setups.map((setup) => setup.channels.map((channel) => (channel.unit ?? 'um').replace('µ', 'u')));
export const unitsPresent = computed(() => (campaign.value ? [...new Set(unitsOf(campaign.value).flat())] : ['um']));
export const unitOfSetup = (given, setup) => unitsOf(given)[setup]?.[0] ?? 'um';
export const unit = computed(() => (unitsPresent.value.includes(shown.value.unit) ? shown.value.unit : unitsPresent.value[0]));

/** One byte a reading: is it drawn? */
export const visible = computed(() => {
  arrived.value;
  const [setup, channel, leftOut] = [column('setup'), column('channel'), column('left_out')];
  if (!setup || !channel) return null;
  const units = unitsOf(campaign.value).map((each) => each.map((one) => one === unit.value));
  const { setup: only, alone } = shown.value;
  const mask = new Uint8Array(setup.length);
  for (let i = 0; i < setup.length; i += 1) {
    mask[i] = units[setup[i]]?.[channel[i]] !== false && (only < 0 || setup[i] === only) && (!alone || alone[i]) && !(leftOut && leftOut[i] === 1) ? 1 : 0;
  }
  return mask;
});

let last = null;

/** That of the model before, until the residuals of the current one are there. */
export const view = computed(() => {
  arrived.value;
  const model = currentModel.value;
  const mask = visible.value;
  const now = model ? column(`residual@${model.number}`) : null;
  if (!now || !mask) return last?.length === mask?.length ? last : null;
  const former = beforeModel.value;
  last = {
    now, before: former ? column(`residual@${former.number}`) : null, length: now.length, shown: mask, lines: linesOfReadings(), sigma: column('stated_sigma'),
    unit: unit.value === 'urad' ? 'µrad' : 'µm', setups: campaign.value.setups, variables: variables.value, column,
  };
  return last;
});

/** What changes under the pointer: what is marked and what is looked at. */
export const overlay = computed(() => ({ selection: selection.value, preview: preview.value }));
