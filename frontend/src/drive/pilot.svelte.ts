import { createContext } from 'svelte';
import { SvelteMap } from 'svelte/reactivity';
import { approach, combine, isNeutral, NEUTRAL, type Axes, type Axis, type Push } from './axes';
import { Handling } from './handling.svelte';

/** ms; 20 Hz while something is held */
const TICK = 50;
/** ticks between two neutrals: 10 Hz, which tell the robot that its pilot is there */
const NEUTRAL_EVERY = 2;
/** by which an axis grows in a tick: from rest to its end in a quarter of a second */
const STEP = 0.2;

export interface Said {
  readonly lease: number;
  readonly sequence: number;
  /** s, the robot's steady clock as this page knows it */
  readonly taken: number;
  readonly axes: Axes;
}

interface PilotPlace {
  /** Send; an old command is worth nothing, so what cannot go now never goes. */
  say(said: Said): void;
  /** s, the robot's steady clock; NaN while unknown */
  now(): number;
  /** the epoch of the control lease; null while this page may not drive or nobody sits before it */
  lease(): number | null;
  /** whether the robot holds this axis by itself */
  keeps(axis: Axis): boolean;
}

/**
 * Drives the robot by what is held, and only by that.
 *
 * It falls silent, after one neutral, as soon as nobody can be taken to look: the robot then comes to rest by itself.
 */
export class Pilot {
  /** what was sent last */
  axes = $state.raw<Axes>(NEUTRAL);
  readonly handling = new Handling();
  readonly #held = new SvelteMap<string, readonly Push[]>();
  #sequence = 0;
  #ticks = 0;
  #lease: number | null = null;

  constructor(private readonly place: PilotPlace) {}

  /** Send as long as there is something to be sent. Returns what ends it. */
  start(): () => void {
    const ticking = setInterval(() => this.#tick(), TICK);
    window.addEventListener('blur', this.rest);
    window.addEventListener('pagehide', this.rest);
    document.addEventListener('visibilitychange', this.rest);
    return () => {
      this.rest();
      clearInterval(ticking);
      window.removeEventListener('blur', this.rest);
      window.removeEventListener('pagehide', this.rest);
      document.removeEventListener('visibilitychange', this.rest);
    };
  }

  /** whether what is held now would move the robot */
  get steers(): boolean {
    return this.place.lease() !== null;
  }

  /** Something is held, from now on at `pushes`; nothing new of it is held where there are none. */
  hold(source: string, pushes: readonly Push[]): void {
    const begins = pushes.length > 0 && !this.#held.has(source);
    const ends = pushes.length === 0 && this.#held.delete(source);
    if (pushes.length > 0) this.#held.set(source, pushes);
    // What begins or ends is said at once; how far a stick moves, with the next tick.
    if (begins || ends) this.#say();
  }

  holds(source: string): boolean {
    return this.#held.has(source);
  }

  /** Let go of everything, and say so. */
  readonly rest = (): void => {
    this.#held.clear();
    if (this.#lease === null) return;
    this.#send(this.#lease, NEUTRAL);
    this.#lease = null;
  };

  #tick(): void {
    this.#ticks += 1;
    const still = isNeutral(this.axes) && this.#held.size === 0;
    if (!still || this.#ticks % NEUTRAL_EVERY === 0 || this.place.lease() === null) this.#say();
  }

  #say(): void {
    const lease = this.place.lease();
    if (lease === null) {
      this.rest();
      return;
    }
    this.#lease = lease;
    const wanted = this.handling.shape(combine(this.#held.values()), (axis) => this.place.keeps(axis));
    this.#send(lease, approach(this.axes, wanted, STEP));
  }

  #send(lease: number, axes: Axes): void {
    this.axes = axes;
    const taken = this.place.now();
    if (Number.isNaN(taken)) return;
    this.#sequence += 1;
    this.place.say({ lease, sequence: this.#sequence, taken, axes });
  }
}

export const [usePilot, providePilot] = createContext<Pilot>();
