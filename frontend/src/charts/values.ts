/** Reading of a cursor on a signal. */
import type { Column } from '../live/ring';
import { unwrap } from './angles';
import type { TimedColumns } from './columns';

/** The values of the samples under a cursor: the least and the greatest of those that share its pixel column. */
export interface Read {
  readonly least: number;
  readonly most: number;
}

/**
 * Value of a signal at `time`: the samples within half of `width` (s) of it, or where there are none the newest before
 * it that is not older than `gap`; null where there is none. The least and the greatest of angles are next to each other:
 * one of them may be beyond π.
 */
export function readAt(ring: TimedColumns, column: Column, time: number, width: number, gap: number, angle = false): Read | null {
  let order = ring.firstSince(time - width / 2);
  let least = Infinity;
  let most = -Infinity;
  let last = NaN;
  const first = order;
  for (; order < ring.length; order += 1) {
    const place = ring.place(order);
    if ((ring.time[place] ?? NaN) > time + width / 2) break;
    const read = column[place] ?? NaN;
    if (Number.isNaN(read)) continue;
    const value = angle ? unwrap(read, last) : read;
    last = value;
    if (value < least) least = value;
    if (value > most) most = value;
  }
  if (least <= most) return { least, most };
  if (order > first || first === 0) return null;
  const place = ring.place(first - 1);
  const value = column[place] ?? NaN;
  return time - (ring.time[place] ?? NaN) > gap || Number.isNaN(value) ? null : { least: value, most: value };
}
