/** Sliders of gains: most that are used lie near the low end of their ranges. */

/** places of a slider */
export const PLACES = 1000;
const DIGITS = 3;

/** The place, 0 to `PLACES`, of a value: by the square, as far as the range has one sign. */
export function placeOf(value: number, least: number, most: number): number {
  const share = (Math.min(Math.max(value, least), most) - least) / (most - least);
  return Math.round(PLACES * (least < 0 ? share : Math.sqrt(share)));
}

/** The value at a place, to three digits. */
export function valueAt(place: number, least: number, most: number): number {
  const share = place / PLACES;
  const value = least + (most - least) * (least < 0 ? share : share * share);
  return Math.min(Math.max(Number(value.toPrecision(DIGITS)), least), most);
}
