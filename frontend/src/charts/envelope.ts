import type { Column } from '../live/ring';

/** What `envelope` needs of a ring. */
export interface TimedColumns {
  readonly length: number;
  readonly time: Float64Array;
  place(order: number): number;
  firstSince(time: number): number;
}

/** A value; `undefined` where the line runs on over the place; `null` where it breaks. */
export type Point = number | null | undefined;

/** Equal pixel columns of absolute time, so that what a column holds does not change while it moves across. */
export interface Span {
  /** number of the first column, counted in column widths from the clock's zero */
  readonly first: number;
  readonly columns: number;
  /** s per column */
  readonly width: number;
}

export function spanOf(now: number, seconds: number, columns: number): Span {
  const width = seconds / columns;
  return { first: Math.floor((now - seconds) / width), columns: columns + 2, width };
}

/** Times of the two points of every column, s before (negative) or after `now`. */
export function times(span: Span, now: number): number[] {
  const { first, columns, width } = span;
  return Array.from({ length: 2 * columns }, (_, index) => (first + (index + 0.5) / 2) * width - now);
}

/**
 * The least and the greatest value in every pixel column, in the order in which they came: two points a column.
 *
 * However many samples share a column, no spike is lost. A column without samples lets the line run on, unless
 * the samples beside it lie more than `gap` s apart.
 */
export function envelope(ring: TimedColumns, column: Column, span: Span, gap: number): Point[] {
  const { first, columns, width } = span;
  const points: Point[] = new Array<Point>(2 * columns).fill(undefined);
  const extremes = { column: -1, low: 0, high: 0, lowTime: 0, highTime: 0 };
  let before: number | null = null;
  for (let order = ring.firstSince(first * width); order < ring.length; order += 1) {
    const place = ring.place(order);
    const time = ring.time[place] ?? NaN;
    const value = column[place] ?? NaN;
    const at = Math.floor(time / width) - first;
    if (at >= columns) break;
    if (at < 0 || Number.isNaN(value)) continue;
    if (at !== extremes.column) {
      write(points, extremes, span);
      if (before !== null && time - before > gap) breakLine(points, extremes.column, at);
      Object.assign(extremes, { column: at, low: value, high: value, lowTime: time, highTime: time });
    } else if (value < extremes.low) {
      extremes.low = value;
      extremes.lowTime = time;
    } else if (value > extremes.high) {
      extremes.high = value;
      extremes.highTime = time;
    }
    before = time;
  }
  write(points, extremes, span);
  return points;
}

interface Extremes {
  column: number;
  low: number;
  high: number;
  lowTime: number;
  highTime: number;
}

function write(points: Point[], extremes: Extremes, span: Span): void {
  const { column, low, high, lowTime, highTime } = extremes;
  if (column < 0) return;
  if (lowTime === highTime) {
    const half = lowTime / span.width - Math.floor(lowTime / span.width) < 0.5 ? 0 : 1;
    points[2 * column + half] = low;
  } else {
    points[2 * column] = lowTime < highTime ? low : high;
    points[2 * column + 1] = lowTime < highTime ? high : low;
  }
}

/** Break the line between two columns. */
function breakLine(points: Point[], from: number, to: number): void {
  points.fill(null, 2 * from + 2, 2 * to);
}
