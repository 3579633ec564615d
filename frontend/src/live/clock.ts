/**
 * The robot's steady clock, told from this computer's.
 *
 * Whatever arrives was written before it arrived, so its time minus the local time is never more than the true
 * offset; the greatest value of the last minute comes nearest. Two half-minute windows let the estimate follow
 * two clocks that drift apart.
 */
export class SteadyClock {
  #current = -Infinity;
  #previous = -Infinity;
  #windowStart = -Infinity;

  /** @param local this computer's steady clock, s */
  constructor(
    private readonly local: () => number,
    private readonly window = 30,
  ) {}

  get known(): boolean {
    return this.#current > -Infinity || this.#previous > -Infinity;
  }

  /** The robot's steady clock now, s; NaN while nothing has been heard of it. */
  now(): number {
    return this.known ? this.local() + Math.max(this.#current, this.#previous) : NaN;
  }

  /** Something written at `steady` arrives now. */
  observe(steady: number): void {
    const local = this.local();
    if (local - this.#windowStart >= this.window) {
      this.#previous = this.#current;
      this.#current = -Infinity;
      this.#windowStart = local;
    }
    this.#current = Math.max(this.#current, steady - local);
  }

  /** Forget everything: another clock speaks, for example after the robot's computer was restarted. */
  reset(): void {
    this.#current = -Infinity;
    this.#previous = -Infinity;
    this.#windowStart = -Infinity;
  }
}

/** One moment on both clocks. */
export interface Instant {
  /** s, the robot's steady clock */
  readonly steady: number;
  /** s since 1970 */
  readonly utc: number;
}

/** The calendar's instant of `steady`, told by a moment that is known on both clocks. */
export function calendar(steady: number, known: Instant | null): Date {
  if (known === null) return new Date(NaN);
  return new Date((known.utc + steady - known.steady) * 1000);
}
