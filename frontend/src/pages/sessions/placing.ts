/** Where the rows of a long list stand, so that only those in view are drawn. */

export interface Group {
  readonly name: string;
  readonly count: number;
}

/** px */
export interface Heights {
  readonly row: number;
  /** of a group's heading; 0: none has one */
  readonly heading: number;
}

/** A row in the list: `index` counts from 0 over all groups. */
export interface PlacedRow {
  readonly index: number;
  /** px from the list's top, its group's heading included */
  readonly top: number;
  readonly height: number;
  /** the group that begins with it */
  readonly group: Group | null;
}

/** px of the whole list */
export const heightOf = (groups: readonly Group[], heights: Heights): number =>
  groups.reduce((sum, { count }) => sum + heights.heading + count * heights.row, 0);

/** The rows that lie between two heights, in px from the list's top. */
export function rowsBetween(groups: readonly Group[], heights: Heights, top: number, bottom: number): PlacedRow[] {
  const rows: PlacedRow[] = [];
  let [start, first] = [0, 0];
  for (const group of groups) {
    const height = heights.heading + group.count * heights.row;
    if (start > bottom) break;
    if (start + height >= top) {
      const from = Math.max(0, Math.floor((top - start - heights.heading) / heights.row));
      const to = Math.min(group.count - 1, Math.floor((bottom - start - heights.heading) / heights.row));
      for (let place = from; place <= Math.max(to, 0) && place < group.count; place += 1) rows.push(placed(group, heights, start, first, place));
    }
    start += height;
    first += group.count;
  }
  return rows;
}

/** The row of this index; null where there is none. */
export function rowAt(groups: readonly Group[], heights: Heights, index: number): PlacedRow | null {
  let [start, first] = [0, 0];
  for (const group of groups) {
    if (index >= first && index < first + group.count) return placed(group, heights, start, first, index - first);
    start += heights.heading + group.count * heights.row;
    first += group.count;
  }
  return null;
}

function placed(group: Group, heights: Heights, start: number, first: number, place: number): PlacedRow {
  const begins = place === 0 && heights.heading > 0;
  return {
    index: first + place,
    top: start + (begins ? 0 : heights.heading + place * heights.row),
    height: heights.row + (begins ? heights.heading : 0),
    group: begins ? group : null,
  };
}
