import type { Timeline } from '../../api';

type Event = Timeline['events'][number];

/** More ticks than these could not be told apart on a screen. */
const PLACES = 500;
const WEIGHT = { info: 0, caution: 1, alarm: 2 } as const;

/** Of all events that fall on one place of the slider, the gravest; `length` is the session's, s. */
export function ticks(events: readonly Event[], length: number): readonly Event[] {
  const places = new Map<number, Event>();
  for (const event of events) {
    const place = Math.round((event.time / length) * PLACES);
    const there = places.get(place);
    if (there === undefined || WEIGHT[event.severity] > WEIGHT[there.severity]) places.set(place, event);
  }
  return [...places.values()];
}
