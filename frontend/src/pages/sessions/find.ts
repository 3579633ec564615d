/** Tags as they are typed, and the choice of sessions as the address says it. */
import type { Seen } from '../../address';
import type { Session, SessionGrouping, SessionQuery } from '../../api';

/** What narrows the list, and what it is grouped by. */
export interface Filters {
  readonly search: string;
  readonly tags: readonly string[];
  readonly origin: Session['origin'] | '';
  readonly controller: string;
  readonly robot: string;
  readonly film: boolean;
  readonly kept: boolean;
  /** local days, 2026-05-31; '' for no limit */
  readonly since: string;
  readonly until: string;
  readonly by: SessionGrouping;
}

export const ORIGINS = ['operator', 'arming', 'scenario', 'simulated', 'import'] as const satisfies readonly Session['origin'][];
export const GROUPINGS = ['none', 'day', 'scenario', 'mission'] as const satisfies readonly SessionGrouping[];
const LENGTHS = { search: 200, controller: 100, robot: 100 };

/** The tags with a new one; what is empty or there already adds nothing. A comma separates several. */
export function withTags(tags: readonly string[], text: string): string[] {
  const known = new Set(tags.map((tag) => tag.toLocaleLowerCase()));
  const added = text
    .split(',')
    .map((tag) => tag.trim())
    .filter((tag) => tag !== '' && !known.has(tag.toLocaleLowerCase()));
  return [...tags, ...new Set(added)];
}

/** What the address says; nonsense counts as nothing. */
export function readFilters(seen: Seen): Filters {
  const text = (name: string) => seen.get(name) ?? '';
  return {
    search: text('search').slice(0, LENGTHS.search),
    tags: withTags([], text('tag')).slice(0, 20),
    origin: ORIGINS.find((origin) => origin === text('origin')) ?? '',
    controller: text('controller').slice(0, LENGTHS.controller),
    robot: text('robot').slice(0, LENGTHS.robot),
    film: text('film') === '1',
    kept: text('kept') === '1',
    since: day(text('since')) === null ? '' : text('since'),
    until: day(text('until')) === null ? '' : text('until'),
    by: GROUPINGS.find((by) => by === text('by')) ?? 'none',
  };
}

/** The same for the address; null takes a name out. */
export function writeFilters(filters: Filters): Record<string, string | null> {
  const given = (value: string) => (value === '' ? null : value);
  return {
    search: given(filters.search),
    tag: given(filters.tags.join(',')),
    origin: given(filters.origin),
    controller: given(filters.controller),
    robot: given(filters.robot),
    film: filters.film ? '1' : null,
    kept: filters.kept ? '1' : null,
    since: given(filters.since),
    until: given(filters.until),
    by: filters.by === 'none' ? null : filters.by,
  };
}

export const NO_FILTERS = readFilters(new Map());

/** Whether less than all is asked for. */
export const narrows = (filters: Filters): boolean => JSON.stringify({ ...filters, search: filters.search.trim(), by: 'none' }) !== JSON.stringify(NO_FILTERS);

/** The same for the server; the last day counts whole. */
export function queryOf(filters: Filters): SessionQuery {
  const [since, until] = [day(filters.since), day(filters.until, 1)];
  return {
    ...(filters.search.trim() === '' ? {} : { search: filters.search.trim() }),
    ...(filters.tags.length === 0 ? {} : { tag: [...filters.tags] }),
    ...(filters.origin === '' ? {} : { origin: filters.origin }),
    ...(filters.controller === '' ? {} : { controller: filters.controller }),
    ...(filters.robot === '' ? {} : { robot: filters.robot }),
    ...(filters.film ? { film: true } : {}),
    ...(filters.kept ? { kept: true } : {}),
    ...(since === null ? {} : { since: since.toISOString() }),
    ...(until === null ? {} : { until: until.toISOString() }),
  };
}

/** The local midnight at which a day begins, or one so many days later; null where there is no such day. */
function day(text: string, later = 0): Date | null {
  const [, year, month, date] = /^(\d{4})-(\d\d)-(\d\d)$/.exec(text) ?? [];
  if (year === undefined) return null;
  const first = new Date(Number(year), Number(month) - 1, Number(date));
  if (first.getMonth() !== Number(month) - 1 || first.getDate() !== Number(date)) return null;
  first.setDate(first.getDate() + later);
  return first;
}
