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
