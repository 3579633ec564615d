import { BUTTONS, pressed, pushesOf, type Button } from './gamepad';
import type { Pilot } from './pilot.svelte';
import { drive as texts } from '../texts/drive';

/** ms between two looks */
const LOOK = 20;
const SOURCE = 'gamepad';
const NAMES = Object.keys(BUTTONS) as Button[];

/** A gamepad at the pilot's hands. It has to be seen with all sticks in the middle before it drives. */
export class Pads {
  /** its name; null while there is none */
  name = $state<string | null>(null);
  /** what there is to tell about it */
  notice = $state('');
  /** whether a stick is to be let go before it counts */
  waits = $state(false);
  #index: number | null = null;
  #down: readonly Button[] = [];
  #looking: ReturnType<typeof setInterval> | undefined;

  /** @param press a button went down; one that is down when the gamepad is first seen did not */
  constructor(
    private readonly pilot: Pilot,
    private readonly press: (button: Button) => void,
  ) {}

  /** Look for gamepads. Returns what ends it. */
  readonly start = (): (() => void) => {
    if (gamepads() === null) this.notice = texts.gamepad.insecure;
    this.#joinAny();
    const join = ({ gamepad }: GamepadEvent) => this.#join(gamepad);
    window.addEventListener('gamepadconnected', join);
    window.addEventListener('gamepaddisconnected', this.#look);
    return () => {
      window.removeEventListener('gamepadconnected', join);
      window.removeEventListener('gamepaddisconnected', this.#look);
      this.#leave();
    };
  };

  #joinAny(): void {
    for (const pad of gamepads() ?? []) this.#join(pad);
  }

  #join(pad: Gamepad | null): void {
    if (!pad?.connected || this.#index !== null) return;
    if (pad.mapping !== 'standard') {
      this.notice = texts.gamepad.unsupported(shortName(pad.id));
      return;
    }
    this.#index = pad.index;
    this.name = shortName(pad.id);
    this.notice = '';
    this.waits = true;
    this.#down = NAMES.filter((name) => pressed(pad, name));
    this.#looking = setInterval(this.#look, LOOK);
    // At once, so that sticks in the middle count from the moment that the gamepad is shown.
    this.#look();
  }

  #leave(): void {
    clearInterval(this.#looking);
    this.pilot.hold(SOURCE, []);
    this.#index = null;
    this.name = null;
  }

  readonly #look = (): void => {
    if (this.#index === null) return;
    const pad = gamepads()?.[this.#index];
    if (!pad?.connected) {
      const gone = this.name ?? texts.gamepad.unnamed;
      this.#leave();
      this.#joinAny();
      this.notice = texts.gamepad.disconnected(gone);
      return;
    }
    const pushes = pushesOf(pad);
    // Nobody meant a stick that was out of the middle before it counted: a new gamepad's, or one of another window.
    this.waits = pushes.length > 0 && (this.waits || !this.pilot.steers);
    this.pilot.hold(SOURCE, this.waits ? [] : pushes);
    const before = this.#down;
    this.#down = NAMES.filter((name) => pressed(pad, name));
    for (const name of this.#down) if (!before.includes(name)) this.press(name);
  };
}

/** The gamepads by their numbers; null where the browser has none for this page: Firefox has them in secure contexts only. */
const gamepads = () => ('getGamepads' in navigator ? navigator.getGamepads() : null);

/** Without the numbers that browsers add for programs. */
const shortName = (id: string): string => id.replace(/\s*\(.*$/, '').trim() || 'Gamepad';
