import type { Code, Field, RowTopic, Rows } from '../generated/topics';
import { BlockError } from './blocks';

export type Column = Float32Array | Float64Array;
type Reader = (view: DataView, at: number) => number;

const READERS: Record<Code, Reader> = {
  b: (view, at) => view.getInt8(at),
  B: (view, at) => view.getUint8(at),
  h: (view, at) => view.getInt16(at, true),
  H: (view, at) => view.getUint16(at, true),
  i: (view, at) => view.getInt32(at, true),
  I: (view, at) => view.getUint32(at, true),
  f: (view, at) => view.getFloat32(at, true),
  d: (view, at) => view.getFloat64(at, true),
};
const BYTES: Record<Code, number> = { b: 1, B: 1, h: 2, H: 2, i: 4, I: 4, f: 4, d: 8 };
/** Whose numbers a Float32Array would round. */
const WIDE: ReadonlySet<Code> = new Set<Code>(['i', 'I', 'd']);

interface Source {
  readonly field: Field;
  readonly read: Reader;
  readonly bytes: number;
  readonly columns: Column[];
}

/** The newest rows of one topic, a typed array for each number; the oldest row makes room for the newest. */
export class RowRing<K extends keyof Rows> {
  readonly time: Float64Array;
  #length = 0;
  #start = 0;
  #end = 0;
  #revision = 0;
  readonly #sources: Source[];

  constructor(
    readonly topic: RowTopic & { readonly name: K },
    readonly capacity: number,
  ) {
    this.time = new Float64Array(capacity);
    this.#sources = topic.fields.map((field) => ({
      field,
      read: READERS[field.code],
      bytes: BYTES[field.code],
      columns: Array.from({ length: field.count }, () =>
        WIDE.has(field.code) ? new Float64Array(capacity) : new Float32Array(capacity),
      ),
    }));
  }

  get length(): number {
    return this.#length;
  }

  /** Number of the row after the newest, counted since the ring was made. */
  get end(): number {
    return this.#end;
  }

  /** Changes where rows became others than before by anything but newer ones that follow. */
  get revision(): number {
    return this.#revision;
  }

  /** Time of the oldest row (s, steady clock); null while there is none. */
  get oldest(): number | null {
    return this.#length === 0 ? null : (this.time[this.place(0)] ?? null);
  }

  /** Time of the newest row (s, steady clock); null while there is none. */
  get newest(): number | null {
    return this.#length === 0 ? null : (this.time[this.place(this.#length - 1)] ?? null);
  }

  /** Where the row of this age order stands in the columns; 0 is the oldest. */
  place(order: number): number {
    const place = this.#start + order;
    return place < this.capacity ? place : place - this.capacity;
  }

  /** Order of the first row that is not before `time`; `length` where there is none. */
  firstSince(time: number): number {
    let low = 0;
    let high = this.#length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((this.time[this.place(middle)] ?? 0) < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** The numbers of one field, in the places that `place` names. */
  column(name: Exclude<keyof Rows[K], 'time'>, element = 0): Column {
    const column = this.#sources.find((source) => source.field.name === name)?.columns[element];
    if (column === undefined) throw new RangeError(`${this.topic.name} has no ${String(name)}[${element}]`);
    return column;
  }

  /** Take in a block's rows that are later than `after` (s, steady clock). Returns how many they were. */
  append(payload: DataView, after: number): number {
    const { rowBytes } = this.topic;
    if (payload.byteLength % rowBytes !== 0) {
      throw new BlockError(`${payload.byteLength} bytes are no rows of ${this.topic.name}, ${rowBytes} bytes each`);
    }
    let taken = 0;
    for (let at = 0; at < payload.byteLength; at += rowBytes) {
      const time = payload.getFloat64(at, true);
      if (time <= after) continue;
      this.#write(payload, at, time);
      taken += 1;
    }
    return taken;
  }

  /** The newest row as an object. */
  latest(): Rows[K] | null {
    return this.#length === 0 ? null : this.row(this.#length - 1);
  }

  /** The row of this age order as an object; 0 is the oldest. */
  row(order: number): Rows[K] {
    const place = this.place(order);
    const row: Record<string, number | number[]> = { time: this.time[place] ?? NaN };
    for (const { field, columns } of this.#sources) {
      const numbers = columns.map((column) => column[place] ?? NaN);
      row[field.name] = field.count > 1 ? numbers : (numbers[0] ?? NaN);
    }
    return row as unknown as Rows[K];
  }

  /** Put a block's rows that are earlier than the oldest one before it, as far as there is room. */
  prepend(payload: DataView): void {
    const { rowBytes } = this.topic;
    if (payload.byteLength % rowBytes !== 0) {
      throw new BlockError(`${payload.byteLength} bytes are no rows of ${this.topic.name}, ${rowBytes} bytes each`);
    }
    const until = this.oldest ?? Infinity;
    for (let at = payload.byteLength - rowBytes; at >= 0 && this.#length < this.capacity; at -= rowBytes) {
      const time = payload.getFloat64(at, true);
      if (time >= until) continue;
      this.#start = this.place(this.capacity - 1);
      this.#length += 1;
      this.#store(payload, at, time, this.#start);
    }
    this.#revision += 1;
  }

  clear(): void {
    this.#length = 0;
    this.#start = 0;
    this.#revision += 1;
  }

  #write(payload: DataView, at: number, time: number): void {
    if (this.#length === this.capacity) this.#start = this.place(1);
    else this.#length += 1;
    this.#end += 1;
    this.#store(payload, at, time, this.place(this.#length - 1));
  }

  #store(payload: DataView, at: number, time: number, place: number): void {
    this.time[place] = time;
    for (const { field, read, bytes, columns } of this.#sources) {
      for (let element = 0; element < columns.length; element += 1) {
        const column = columns[element];
        if (column) column[place] = read(payload, at + field.offset + element * bytes) * field.scale;
      }
    }
  }
}
