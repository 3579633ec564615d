import { ROW_TOPICS, type Rows } from '../generated/topics';
import { HISTORY, PERIODS, RATES_MOST } from './periods';
import { RowRing } from './ring';

export type Rings = { readonly [K in keyof Rows]: RowRing<K> };

/** An empty ring for every topic of rows, large enough for what the server keeps. */
export function createRings(): Rings {
  const names = Object.keys(ROW_TOPICS) as (keyof Rows)[];
  const capacity = (name: keyof Rows) => Math.ceil(HISTORY * (RATES_MOST[name] ?? 1 / PERIODS[name]));
  const rings = names.map((name) => [name, new RowRing(ROW_TOPICS[name], capacity(name))]);
  return Object.fromEntries(rings) as Rings;
}

/** Per topic, how many samples never came, told by their numbers. */
export class Gaps {
  readonly #next = new Map<number, number>();
  readonly #missed = new Map<number, number>();

  /** A block came whose first sample has this number. Numbers that fall back mean that its writer started anew. */
  observe(topic: number, first: number, count: number): void {
    const expected = this.#next.get(topic);
    if (expected !== undefined && first > expected) {
      this.#missed.set(topic, this.missed(topic) + first - expected);
    }
    this.#next.set(topic, first + count);
  }

  missed(topic: number): number {
    return this.#missed.get(topic) ?? 0;
  }

  /** Samples that follow need not join on to those before, for example after a connection was lost. */
  restart(): void {
    this.#next.clear();
  }
}

/** Until when each topic is known. A new connection replays what went before, which is not to be taken twice. */
export class Progress {
  readonly #reached = new Map<number, number>();
  #known: ReadonlyMap<number, number> = new Map();

  /** s, steady clock: samples of this connection up to here were taken in over an earlier one */
  knownUntil(topic: number): number {
    return this.#known.get(topic) ?? -Infinity;
  }

  reach(topic: number, time: number): void {
    this.#reached.set(topic, time);
  }

  /** A new connection begins. */
  reconnect(): void {
    this.#known = new Map(this.#reached);
  }

  forget(): void {
    this.#reached.clear();
    this.#known = new Map();
  }
}
