import type { Live } from '../live/live.svelte';
import { moved, viewUntil, within, zoomed, type View } from './view';

/** A held view: up to when, and how long where it was zoomed. */
interface Held {
  readonly end: number;
  /** s; null while each chart shows its own span */
  readonly seconds: number | null;
}

/**
 * The time that the charts of a page show: pause, zoom and cursor are of all of them together, so that one moment is
 * looked at in all.
 */
export class ChartTime {
  held = $state.raw<Held | null>(null);
  /** where the cursor stands, in s before the charts' right edge, also beyond what they show; null where there is none */
  ago = $state<number | null>(null);

  /** View of a chart of a span of `seconds` at `now`. */
  view(seconds: number, now: number): View {
    return viewUntil(this.held?.end ?? now, this.held?.seconds ?? seconds);
  }

  /** whether the charts show something else than each its own span */
  get zoomed(): boolean {
    return this.held !== null && this.held.seconds !== null;
  }

  /** The moment under the cursor; null where there is none. */
  moment(now: number): number | null {
    return this.ago === null ? null : (this.held?.end ?? now) - this.ago;
  }

  /** Put the cursor onto a moment; null takes it away. */
  point(moment: number | null, now: number): void {
    this.ago = moment === null ? null : (this.held?.end ?? now) - moment;
  }

  pause(now: number): void {
    if (Number.isFinite(now)) this.held ??= { end: now, seconds: null };
  }

  readonly resume = (): void => {
    this.held = null;
  };

  toggle(now: number): void {
    if (this.held === null) this.pause(now);
    else this.resume();
  }

  /** Each chart shows its own span again. */
  unzoom(): void {
    if (this.held !== null) this.held = { end: this.held.end, seconds: null };
  }

  /** Show this and nothing else. */
  show(view: View, now: number): void {
    if (!Number.isFinite(now)) return;
    const shown = within(view, now);
    const cursor = this.moment(now);
    this.held = { end: shown.end, seconds: shown.seconds };
    this.ago = cursor === null ? null : Math.min(Math.max(shown.end - cursor, 0), shown.seconds);
  }

  zoom(view: View, factor: number, around: number, now: number): void {
    this.show(zoomed(view, factor, around), now);
  }

  move(view: View, by: number, now: number): void {
    this.show(moved(view, by), now);
  }
}

const times = new WeakMap<Live, ChartTime>();

/** The time of all charts that show this. */
export function chartTime(live: Live): ChartTime {
  const known = times.get(live) ?? new ChartTime();
  times.set(live, known);
  return known;
}
