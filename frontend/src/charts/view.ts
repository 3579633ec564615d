/** Which stretch of time charts show, and how it is zoomed and moved. Times in s, steady clock. */
import { HISTORY_SHOWN } from '../live/periods';
import { charts as texts } from '../texts/charts';

/** `seconds` is kept rather than computed: a difference of large numbers would not be the same each time. */
export interface View {
  readonly start: number;
  readonly end: number;
  readonly seconds: number;
}

/** s that charts show, to choose from */
export const SPANS: readonly { readonly seconds: number; readonly title: string }[] = [
  { seconds: 10, title: texts.spans.s10 },
  { seconds: 30, title: texts.spans.s30 },
  { seconds: 60, title: texts.spans.m1 },
  { seconds: 120, title: texts.spans.m2 },
  { seconds: 300, title: texts.spans.m5 },
  { seconds: 600, title: texts.spans.m10 },
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
