/** The times that were filmed. */

/** From `start` to `end`, s since the session's start. */
export interface Span {
  readonly start: number;
  readonly end: number;
}

/** s by which a film may begin after, or end before, what it is shown with */
const MARGIN = 1;

/** Whether there is film of a moment. */
export const isFilmed = (at: number, spans: readonly Span[]): boolean => spans.some(({ start, end }) => start - MARGIN <= at && at <= end + MARGIN);

/** The nearest moment from `at` on that was filmed; without one the last. */
export function filmedMoment(at: number, spans: readonly Span[]): number {
  const span = spans.find(({ end }) => end >= at) ?? spans.at(-1);
  return span === undefined ? at : Math.max(span.start, Math.min(at, span.end));
}
