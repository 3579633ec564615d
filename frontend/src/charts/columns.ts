import type { Column } from '../live/ring';
import { unwrap } from './angles';
import type { View } from './view';

/** The part of a ring that `Columns` reads. */
export interface TimedColumns {
  readonly length: number;
  readonly time: Float64Array;
  /** number of the row after the newest, counted since the ring was made */
  readonly end: number;
  /** changes where rows became others than before by anything but newer ones that follow */
  readonly revision: number;
  /** time of the oldest row, s; null while there is none */
  readonly oldest: number | null;
  place(order: number): number;
  firstSince(time: number): number;
}

/** Equal pixel columns of absolute time, so that what a column holds does not change while it moves across. */
export interface Span {
  /** number of the first column, counted in column widths from the clock's zero */
  readonly first: number;
  readonly columns: number;
  /** s per column */
  readonly width: number;
}

/** The columns that show a view that is so many of them wide. */
export function spanOf({ start, seconds }: View, columns: number): Span {
  const width = seconds / columns;
  return { first: Math.floor(start / width), columns: columns + 2, width };
}

/** Order of a column's samples: none, the least first, the greatest first. */
export const Order = { NONE: 0, RISING: 1, FALLING: 2 } as const;

/**
 * The least and the greatest value in every pixel column: however many samples share a column, no spike is lost.
 *
 * A column is looked at once. As time goes on, `update` takes in the new samples alone; only another width, a step
 * back or a ring that has changed have it begin anew.
 */
export class Columns {
  low = new Float64Array(0);
  high = new Float64Array(0);
  order = new Uint8Array(0);
  /** 1 where the line breaks before the column */
  broken = new Uint8Array(0);
  #room = 0;
  #width = NaN;
  #first = 0;
  #end = 0;
  /** number of the first row that was not looked at */
  #row = 0;
  #revision = -1;
  #before = NaN;
  #newest = NaN;

  /** @param ring whose `column` this is; @param angle whether its values are angles, which are unwrapped */
  constructor(
    private readonly ring: TimedColumns,
    private readonly column: Column,
    private readonly angle = false,
  ) {}

  /** The newest value that was taken in; NaN before the first. */
  get newest(): number {
    return this.#newest;
  }

  /** Where the column of this number stands in the arrays. */
  readonly place = (number: number): number => number % this.#room;

  /** Look at what is new in `span`. The line breaks where samples lie more than `gap` s apart. */
  update(span: Span, gap: number): void {
    const { first, columns, width } = span;
    const end = first + columns;
    if (
      width !== this.#width ||
      columns > this.#room ||
      first < this.#first ||
      first > this.#end ||
      this.ring.revision !== this.#revision
    ) {
      this.#begin(span);
    }
    this.#first = first;
    while (this.#end < end) {
      this.order[this.place(this.#end)] = Order.NONE;
      this.broken[this.place(this.#end)] = 0;
      this.#end += 1;
    }
    this.#take(end, gap);
  }

  /** The least and the greatest value of the columns of `span`; null where they are empty. */
  range({ first, columns }: Span): readonly [number, number] | null {
    let least = Infinity;
    let most = -Infinity;
    for (let number = first; number < first + columns; number += 1) {
      const place = this.place(number);
      if (this.order[place] === Order.NONE) continue;
      least = Math.min(least, this.low[place] ?? Infinity);
      most = Math.max(most, this.high[place] ?? -Infinity);
    }
    return least <= most ? [least, most] : null;
  }

  /** The value with which the line begins in `span`; NaN where that is empty. */
  oldest({ first, columns }: Span): number {
    for (let number = first; number < first + columns; number += 1) {
      const place = this.place(number);
      if (this.order[place] !== Order.NONE) return (this.order[place] === Order.RISING ? this.low[place] : this.high[place]) ?? NaN;
    }
    return NaN;
  }

  #begin({ first, columns, width }: Span): void {
    if (columns > this.#room) {
      this.#room = columns + 64;
      this.low = new Float64Array(this.#room);
      this.high = new Float64Array(this.#room);
      this.order = new Uint8Array(this.#room);
      this.broken = new Uint8Array(this.#room);
    }
    this.#width = width;
    this.#end = first;
    this.#revision = this.ring.revision;
    this.#row = this.ring.end - this.ring.length + this.ring.firstSince(first * width);
    this.#before = this.#newest = NaN;
  }

  #take(end: number, gap: number): void {
    const { ring, column, low, high, order } = this;
    const width = this.#width;
    const oldest = ring.end - ring.length;
    let row = Math.max(this.#row, oldest);
    for (; row < ring.end; row += 1) {
      const at = ring.place(row - oldest);
      const time = ring.time[at] ?? NaN;
      const number = Math.floor(time / width);
      if (number >= end) break;
      const read = column[at] ?? NaN;
      const value = this.angle ? unwrap(read, this.#newest) : read;
      if (number < this.#first) continue;
      if (Number.isNaN(value)) {
        // Until the next value the line is broken, however soon that comes.
        this.#before = -Infinity;
        continue;
      }
      const place = this.place(number);
      if (order[place] === Order.NONE) {
        if (time - this.#before > gap) this.broken[place] = 1;
        low[place] = high[place] = value;
        order[place] = Order.RISING;
      } else if (value < (low[place] ?? NaN)) {
        low[place] = value;
        order[place] = Order.FALLING;
      } else if (value > (high[place] ?? NaN)) {
        high[place] = value;
        order[place] = Order.RISING;
      }
      this.#before = time;
      this.#newest = value;
    }
    this.#row = row;
  }
}
