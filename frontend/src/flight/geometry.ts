/** Where the marks of the flight view stand, px. */

export interface Rect {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export interface Mark {
  /** from the tape's middle: to the right, or down */
  readonly at: number;
  readonly value: number;
  /** true for a long mark with its value */
  readonly named: boolean;
}

/** The largest rectangle of this shape in the middle of a room: a picture is neither cut off nor squeezed. */
export function fit(width: number, height: number, picture: { readonly width: number; readonly height: number }): Rect {
  const scale = Math.min(width / picture.width, height / picture.height);
  const [across, down] = [picture.width * scale, picture.height * scale];
  return { x: (width - across) / 2, y: (height - down) / 2, width: across, height: down };
}

/**
 * Marks of a straight tape that shows `value` in its middle and `reach` px either side.
 *
 * @param perUnit px
 * @param step between two marks, in the value's unit
 * @param every one of so many has its value written beside it
 * @param least the tape begins here
 */
export function tapeMarks(value: number, reach: number, perUnit: number, step: number, every: number, least = -Infinity): Mark[] {
  const first = Math.ceil(Math.max(value - reach / perUnit, least) / step - 1e-9);
  const last = Math.floor((value + reach / perUnit) / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, index) => {
    const number = first + index;
    return { at: (number * step - value) * perUnit, value: number * step, named: number % every === 0 };
  });
}

/** Marks of a compass tape each 10°; their values lie within 0 to 359. */
export function compassMarks(heading: number, reach: number, perDegree: number): Mark[] {
  return tapeMarks(heading, reach, perDegree, 10, 3).map((mark) => ({ ...mark, value: ((mark.value % 360) + 360) % 360 }));
}

/** ° from one heading to another, the short way round: -180 to 180. */
export const turnTo = (from: number, to: number): number => ((((to - from + 180) % 360) + 360) % 360) - 180;

/** A place on the tape, or the end beyond which it lies. */
export function onTape(at: number, reach: number): { readonly at: number; readonly beyond: boolean } {
  const beyond = Math.abs(at) > reach;
  return { at: beyond ? Math.sign(at) * reach : at, beyond };
}

/** The point of the compass at a heading of a whole 30°; the degrees, in tens, between two. */
export function compassName(degrees: number): string {
  return { 0: 'N', 90: 'E', 180: 'S', 270: 'W' }[degrees] ?? String(degrees / 10).padStart(2, '0');
}
