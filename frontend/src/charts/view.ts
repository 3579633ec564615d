/** Which stretch of time charts show, and how it is zoomed and moved. Times in s, steady clock. */
import { HISTORY_SHOWN } from '../live/periods';

/** `seconds` is kept rather than computed: a difference of large numbers would not be the same each time. */
export interface View {
  readonly start: number;
  readonly end: number;
  readonly seconds: number;
}

/** s that charts show, to choose from */
export const SPANS: readonly { readonly seconds: number; readonly title: string }[] = [
  { seconds: 10, title: '10 s' },
  { seconds: 30, title: '30 s' },
  { seconds: 60, title: '1 min' },
  { seconds: 120, title: '2 min' },
  { seconds: 300, title: '5 min' },
  { seconds: 600, title: '10 min' },
];

/** s; ten samples at 100 Hz */
export const LEAST = 0.1;

export function viewUntil(end: number, seconds: number): View {
  return { start: end - seconds, end, seconds };
}

/** The view as near to this one as it may be: not too short, not beyond what the rings hold at `now`. */
export function within({ end, seconds }: View, now: number): View {
  const shown = Math.min(Math.max(seconds, LEAST), HISTORY_SHOWN);
  return viewUntil(Math.min(Math.max(end, now - HISTORY_SHOWN + shown), now), shown);
}

/** The view with `factor` times its length, in which `around` stays where it is on the screen. */
export function zoomed({ end, seconds }: View, factor: number, around: number): View {
  const wanted = Math.min(Math.max(seconds * factor, LEAST), HISTORY_SHOWN);
  return viewUntil(around + (end - around) * (wanted / seconds), wanted);
}

export function moved({ end, seconds }: View, by: number): View {
  return viewUntil(end + by, seconds);
}
