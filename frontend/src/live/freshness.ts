/** State of a value by its age: `none` never came, `stale` came too long ago. */
export interface Freshness {
  readonly state: 'none' | 'fresh' | 'stale';
  /** s; null where nothing ever came */
  readonly age: number | null;
}

const LEAST_LIMIT = 1;
const PERIODS_MISSED = 3;

/** Age, in s, from which a value that should come every `period` s is stale. */
export function staleAfter(period: number): number {
  return Math.max(LEAST_LIMIT, PERIODS_MISSED * period);
}

/** Freshness of a value of `time` at `now` (s, both of one clock), where one is due every `period` s. */
export function freshness(time: number | null, now: number, period: number): Freshness {
  if (time === null || Number.isNaN(now)) return { state: 'none', age: null };
  const age = Math.max(0, now - time);
  return { state: age > staleAfter(period) ? 'stale' : 'fresh', age };
}

/** The least fresh of several. */
export function worst(all: readonly Freshness[]): Freshness {
  const order = { none: 0, fresh: 1, stale: 2 } as const;
  let found: Freshness = { state: 'none', age: null };
  for (const one of all) {
    if (order[one.state] > order[found.state] || (one.state === found.state && (one.age ?? 0) > (found.age ?? 0))) {
      found = one;
    }
  }
  return found;
}
