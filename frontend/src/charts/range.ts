/** Ranges of y axes: round, and not another with every sample. */

export type Range = readonly [number, number];

const STEPS = [0.5, 1, 1.5, 2, 3, 4, 5, 7.5, 10];
const DEPTH_LEAST = 0.6;
/** share of a value below which differences are none */
const FLAT = 1e-6;
/** least part of a range that data must fill, so that it stays */
const FILLED = 0.7;

/** A round depth (m) that shows all of `deepest` with some room below it. */
export function depthRange(deepest: number): number {
  const wanted = deepest * 1.08;
  return STEPS.find((step) => step >= wanted) ?? Math.ceil(wanted / 5) * 5;
}

/** The range of an axis of depths: 0 is in it, since that is the surface. */
export function depthsRange(least: number, most: number): Range {
  const deepest = depthRange(Math.max(most, DEPTH_LEAST));
  return [Math.min(-0.04 * deepest, least * 1.08), deepest];
}

/** A round range in which all from `least` to `most` is seen with some room. */
export function roundRange(least: number, most: number): Range {
  const size = Math.max(Math.abs(least), Math.abs(most));
  const room = most - least > size * FLAT ? (most - least) * 0.06 : size * 0.02 || 1;
  const step = roundStep((most - least + 2 * room) / 4);
  return [Math.floor((least - room) / step) * step, Math.ceil((most + room) / step) * step];
}

/** The range before, while the data still fill it well; else a new one. */
export function settle(before: Range | null, data: Range | null, choose: (least: number, most: number) => Range): Range {
  if (data === null) return before ?? choose(0, 0);
  const [least, most] = data;
  const wanted = choose(least, most);
  if (before === null || least < before[0] || most > before[1]) return wanted;
  return wanted[1] - wanted[0] < FILLED * (before[1] - before[0]) ? wanted : before;
}

function roundStep(rough: number): number {
  const ten = 10 ** Math.floor(Math.log10(rough));
  return ([1, 2, 2.5, 5, 10].find((step) => step * ten >= rough) ?? 10) * ten;
}
