// A surface as the program sends it, as the drawing of the reports takes it.
import { titleOf, unitText } from './variables.js';

const named = (driver, variables) => {
  const name = typeof driver === 'string' ? driver : driver.name;
  if (name === 't') return { name, label: 'time', unit: 's' };
  return { name, label: name, unit: '', ...variables.find((variable) => variable.name === name) };
};

function largestAt(value) {
  let best = 0;
  value.forEach((v, k) => { if (Math.abs(v) > Math.abs(value[best])) best = k; });
  return best;
}

/** Places of the largest value: of one driver, or of two with the last running fastest. */
function placeOf(k, places) {
  if (places.length === 1) return [places[0][k]];
  const inner = places[1].length;
  return [places[0][Math.floor(k / inner)], places[1][k % inner]];
}

export function surfaceData(surface, variables) {
  const drivers = surface.drivers.map((driver) => named(driver, variables));
  const places = surface.places.slice(0, 2);
  const at = largestAt(surface.value);
  return {
    label: surface.label, unit: unitText(surface.unit), target: surface.target ?? 'value', factor: '', third: surface.third ?? null, third_at: surface.third_at ?? null,
    axes: drivers.slice(0, 2).map((driver, k) => ({ name: driver.label, title: titleOf(driver), places: places[k], dots: surface.dots?.[k] ?? [] })),
    value: surface.value, U95: surface.u95, at: placeOf(at, places), largest: surface.value[at], largest_U95: surface.u95[at], formulas: [],
  };
}

/** Where a surface or curve is largest, and how far at least half of that reaches along every driver. */
export function outlineOf(surface) {
  const places = surface.places.slice(0, 2);
  const best = largestAt(surface.value);
  const inner = places.length > 1 ? places[1].length : 1;
  const at = places.length > 1 ? [Math.floor(best / inner), best % inner] : [best];
  const valueAt = (index) => surface.value[places.length > 1 ? index[0] * inner + index[1] : index[0]];
  const reach = (axis, step) => {
    const index = [...at];
    while (index[axis] + step >= 0 && index[axis] + step < places[axis].length) {
      index[axis] += step;
      if (valueAt(index) / surface.value[best] < 0.5) return places[axis][index[axis] - step];
    }
    return places[axis][index[axis]];
  };
  return { largest: surface.value[best], u95: surface.u95[best], at: at.map((k, axis) => places[axis][k]), from: at.map((_, axis) => reach(axis, -1)), to: at.map((_, axis) => reach(axis, 1)) };
}
