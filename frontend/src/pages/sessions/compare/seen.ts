/** What the address says of a comparison: `from` and `to` (s on the common axis), `signals`, `align`, `figures` and `segments`. */
import type { Align, SegmentChoice } from '../../../api';
import type { View } from './figure';

/** of a chart; more in an address are passed over */
export const MOST_SIGNALS = 24;
const LONGEST = 100;
const MOST_STEPS = 999;

/** The signals that an address names, each once. */
export function readSignals(text: string): string[] {
  const names = text.split(',').filter((name) => name !== '' && name.length <= LONGEST);
  return [...new Set(names)].slice(0, MOST_SIGNALS);
}

/** What begins together, as `start`, `armed`, `segment`, `set_point:2`, `marker:text` or `mission:step`; the start where it is none of these. */
export function readAlign(text: string): Align {
  const start = { by: 'start', number: 1, marker: '', step: '' } as const;
  const [by = '', which = ''] = text.split(/:(.*)/s);
  if (by === 'armed' || by === 'segment') return { ...start, by };
  if (by === 'marker' && which.length <= LONGEST) return { ...start, by, marker: which };
  if (by === 'mission' && which.length <= LONGEST) return { ...start, by, step: which };
  const number = Number(which);
  return by === 'set_point' && Number.isInteger(number) && number >= 1 && number <= MOST_STEPS ? { ...start, by, number } : start;
}

/** The same for the address; null for the start, which needs no word. */
export function writeAlign({ by, number, marker, step }: Align): string | null {
  if (by === 'start') return null;
  if (by === 'set_point') return `${by}:${number}`;
  return by === 'armed' || by === 'segment' ? by : `${by}:${by === 'marker' ? marker : step}`;
}

/** A part of the time; null where the address names none, or its end does not come after its start. */
export function readView(from: number | null, to: number | null): View | null {
  return from === null || to === null || to <= from ? null : { start: from, end: to };
}

/** The part of the time that the figures cover, as `12.5,30`; null where it is none. */
export function readFigures(text: string): View | null {
  const [start = NaN, end = NaN, ...more] = text.split(',').map((one) => (one.trim() === '' ? NaN : Number(one)));
  return more.length === 0 && Number.isFinite(start) && Number.isFinite(end) ? readView(start, end) : null;
}

/** The same for the address. */
export function writeFigures(view: View): string {
  const { start, end } = rounded(view);
  return `${start},${end}`;
}

/** To the millisecond, as it stands in an address. */
export const rounded = ({ start, end }: View): View => ({ start: Number(start.toFixed(3)), end: Number(end.toFixed(3)) });

/** In the address where the server takes the segments that are most alike. */
export const MOST_ALIKE = 'like';
const MOST_SEGMENTS = 200;

/** The chosen segments of these sessions, as `7:2,9:1`; those that are none are passed over. */
export function readSegments(text: string, ids: readonly number[]): SegmentChoice[] {
  const pairs = text.split(',').map((pair) => pair.split(':').map(Number));
  return ids.flatMap((session) => {
    const segment = pairs.find(([id]) => id === session)?.[1] ?? 0;
    return Number.isInteger(segment) && segment >= 1 && segment <= MOST_SEGMENTS ? [{ session, segment }] : [];
  });
}

export const writeSegments = (choices: readonly SegmentChoice[]): string => choices.map(({ session, segment }) => `${session}:${segment}`).join(',') || MOST_ALIKE;
