/** What is studied, as the address says it, and the shapes of its charts. */
import type { Seen } from '../../address';
import type { FigureQuery, FigureStudy } from '../../api';

export type Figure = NonNullable<FigureQuery['figure']>;
export type Group = NonNullable<FigureQuery['by']>;
type Of = NonNullable<FigureQuery['of']>;

export const FIGURES = ['rmse', 'overshoot', 'settling_time', 'cycle_amplitude', 'deepest', 'duration', 'fin_strokes', 'frames_lost', 'alarms'] as const satisfies readonly Figure[];
export const GROUPS = ['none', 'controller', 'gains', 'craft', 'firmware', 'software', 'robot'] as const satisfies readonly Group[];
export const OFS = ['session', 'segment'] as const satisfies readonly Of[];

/** What is asked for; '' where nothing narrows. */
export interface Study {
  readonly figure: Figure;
  readonly of: Of;
  readonly by: Group;
  readonly search: string;
  readonly robot: string;
  /** local days, 2026-05-31 */
  readonly since: string;
  readonly until: string;
}

const DAY = /^\d{4}-\d\d-\d\d$/;

/** What the address says; nonsense counts as nothing. */
export function readStudy(seen: Seen): Study {
  const text = (name: string, most = 100) => (seen.get(name) ?? '').slice(0, most);
  const day = (name: string) => (DAY.test(text(name)) ? text(name) : '');
  return {
    figure: FIGURES.find((figure) => figure === text('figure')) ?? 'rmse',
    of: OFS.find((of) => of === text('of')) ?? 'session',
    by: GROUPS.find((by) => by === text('by')) ?? 'none',
    search: text('search', 200),
    robot: text('robot'),
    since: day('since'),
    until: day('until'),
  };
}

/** The same for the server; the last day counts whole. */
export function queryOf(study: Study): FigureQuery {
  const midnight = (day: string, later = 0) => {
    const [year = 0, month = 1, date = 1] = day.split('-').map(Number);
    return new Date(year, month - 1, date + later).toISOString();
  };
  return {
    figure: study.figure,
    of: study.of,
    by: study.by,
    ...(study.search.trim() === '' ? {} : { search: study.search.trim() }),
    ...(study.robot === '' ? {} : { robot: study.robot }),
    ...(study.since === '' ? {} : { since: midnight(study.since) }),
    ...(study.until === '' ? {} : { until: midnight(study.until, 1) }),
  };
}

export interface Point {
  readonly x: number;
  readonly y: number;
}

/** The bars of a group between 0 and 1 both ways: the tallest bar of all groups is 1. */
export function barsOf(bins: readonly number[], tallest: number): readonly { readonly x: number; readonly width: number; readonly height: number }[] {
  const width = 1 / Math.max(bins.length, 1);
  return bins.map((count, index) => ({ x: index * width, width, height: tallest > 0 ? count / tallest : 0 }));
}

/** Where a value lies between the outermost edges, 0 to 1. */
export function placeOf(value: number, edges: readonly number[]): number {
  const [low, high] = [edges[0] ?? 0, edges.at(-1) ?? 1];
  return Math.min(1, Math.max(0, (value - low) / (high - low || 1)));
}

/** Median and middle half over time, each point between 0 and 1; y grows upwards. */
export function courseOf(study: FigureStudy): { readonly median: readonly Point[]; readonly band: readonly Point[]; readonly low: number; readonly high: number } {
  const periods = study.course;
  const times = periods.map(({ start }) => Date.parse(start));
  const [from, to] = [times[0] ?? 0, times.at(-1) ?? 1];
  const low = Math.min(...periods.map((period) => period.low));
  const high = Math.max(...periods.map((period) => period.high));
  const x = (index: number) => (to === from ? 0.5 : ((times[index] ?? from) - from) / (to - from));
  const y = (value: number) => (high === low ? 0.5 : (value - low) / (high - low));
  const line = (of: 'low' | 'median' | 'high') => periods.map((period, index) => ({ x: x(index), y: y(period[of]) }));
  return { median: line('median'), band: [...line('high'), ...line('low').reverse()], low, high };
}
