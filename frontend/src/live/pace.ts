/** Part of a step by which new samples are drawn early. */
const EARLY = 0.5;

/**
 * When something that moves with time is drawn anew: once a step, and where samples came as soon as half a step has
 * passed, so that they do not wait for the next one. Time that is lost between two frames of the screen is made up.
 */
export class Pace {
  #due = Infinity;
  #drawn = Infinity;

  /** True where it is time to draw at `now` (s), with `step` s from one drawing to the next; `fresh`: samples came since the last one. */
  isDue(now: number, step: number, fresh: boolean): boolean {
    const due = Math.min(this.#due, this.#drawn + step);
    if (now >= this.#drawn && now < (fresh ? due - EARLY * step : due)) return false;
    this.#due = Math.max(Math.min(due, now), now - step) + step;
    this.#drawn = now;
    return true;
  }
}
