import { readStoredJson, writeStored } from '../storage';
import { driven, isNeutral, NEUTRAL, type Axes, type Axis } from './axes';

export const SPEEDS = 9;
const SPEED_FIRST = 6;
/** shares of full; small, since it is there to make up for what swims askew */
export const TRIM_STEP = 0.02;
export const TRIM_MOST = 0.2;
const KEY = 'mucat-handling';

/** The way from sticks to commands: the speed step and the trim, which outlast a reload of this tab and nothing else. */
export class Handling {
  /** 1 to SPEEDS */
  speed = $state(SPEED_FIRST);
  /** added on each axis while something is held */
  trim = $state.raw<Axes>(NEUTRAL);

  constructor() {
    // Another version may have written something else: then all begins as it comes.
    const { speed, trim } = Object(readStoredJson(KEY, 'sessionStorage')) as { speed?: unknown; trim?: unknown };
    if (typeof speed === 'number') this.setSpeed(speed);
    if (Array.isArray(trim)) NEUTRAL.forEach((_, axis) => this.setTrim(axis as Axis, Number(trim[axis]) || 0));
  }

  /** of full speed */
  get share(): number {
    return this.speed / SPEEDS;
  }

  get trimmed(): boolean {
    return !isNeutral(this.trim);
  }

  setSpeed(speed: number): void {
    this.speed = Math.min(SPEEDS, Math.max(1, Math.round(speed)));
    this.#keep();
  }

  setTrim(axis: Axis, value: number): void {
    const steps = Math.round(Math.min(TRIM_MOST, Math.max(-TRIM_MOST, value)) / TRIM_STEP);
    // Whole steps, so that as many up as down are none.
    this.trim = this.trim.map((one, place) => (place === axis ? steps * TRIM_STEP : one)) as unknown as Axes;
    this.#keep();
  }

  resetTrim(): void {
    this.trim = NEUTRAL;
    this.#keep();
  }

  /** @param kept whether the robot holds this axis by itself */
  shape(sticks: Axes, kept: (axis: Axis) => boolean): Axes {
    return driven(sticks, this.share, this.trim, kept);
  }

  #keep(): void {
    writeStored(KEY, JSON.stringify({ speed: this.speed, trim: this.trim }), 'sessionStorage');
  }
}
