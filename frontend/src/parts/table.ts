/** Columns of a table, its selection, and the order of its rows. */
import type { Snippet } from 'svelte';

export type Key = string | number;

export interface Paint {
  readonly fill: string;
  readonly ink: string;
}

export interface Column<Row> {
  heading: string;
  /** the heading is for screen readers alone */
  unseen?: boolean;
  /** asked for by pressing the heading */
  meaning?: string;
  /** `name`: tells the row from others; `actions`: its buttons */
  kind?: 'name' | 'number' | 'actions';
  text?: ((row: Row) => Key) | undefined;
  /** of all its values, beside the heading */
  unit?: string;
  /** of the line in a chart that the column is about */
  colour?: string;
  /** colours of its cells; null: none */
  paint?: (row: Row) => Paint | null;
  /** a second, quieter line below the text */
  about?: ((row: Row) => string) | undefined;
  /** the cell's contents where they are more than text, by the row and the column's place */
  cell?: Snippet<[Row, number]>;
  /** by which rows are sorted where somebody presses the heading */
  sort?: (row: Row) => Key | null;
  /** columns of a phone's card that it takes */
  span?: number;
  /** of its cells, heading included */
  class?: string;
}

export interface Selection<Row> {
  heading: string;
  label: (row: Row) => string;
  chosen: (row: Row) => boolean;
  toggle: (row: Row) => void;
  /** one row at a time */
  single?: boolean;
  refused?: (row: Row) => boolean;
}

export interface Order {
  heading: string;
  descending: boolean;
}

/** Return the order after a press on a heading: ascending, descending, then that of the rows themselves. */
export function nextOrder(order: Order | null, heading: string): Order | null {
  if (order?.heading !== heading) return { heading, descending: false };
  return order.descending ? null : { heading, descending: true };
}

/** Return the rows in this order; rows without a value come last either way. */
export function inOrder<Row>(rows: readonly Row[], columns: readonly Column<Row>[], order: Order | null): readonly Row[] {
  const value = columns.find(({ heading }) => heading === order?.heading)?.sort;
  if (order === null || value === undefined) return rows;
  const sign = order.descending ? -1 : 1;
  return [...rows].sort((one, other) => {
    const [left, right] = [value(one), value(other)];
    if (left === null || right === null) return Number(left === null) - Number(right === null);
    return sign * compare(left, right);
  });
}

function compare(one: Key, other: Key): number {
  return typeof one === 'number' && typeof other === 'number' ? one - other : String(one).localeCompare(String(other), undefined, { numeric: true });
}

/** Return what is selected with `one` added at the end, or taken out. */
export function toggle<T>(selected: readonly T[], one: T): T[] {
  return selected.includes(one) ? selected.filter((other) => other !== one) : [...selected, one];
}
