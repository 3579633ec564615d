import type { Button, PadProfile } from './gamepad';
import type { Pilot } from './pilot.svelte';
import { vibrate, type Vibration } from './vibration';
import { drive as texts } from '../texts/drive';

/** A gamepad at the pilot's hands. It has to be seen with all sticks in the middle before it drives. */
export class Pads {
  /** its name; null while there is none */
  name = $state<string | null>(null);
  /** what there is to tell about it */
  notice = $state('');
  /** whether a stick is to be let go before it counts */
  waits = $state(false);
  /** its assignments */
  profile = $state.raw<PadProfile | null>(null);
  /** its number in the browser's list */
  index: number | null = null;

  /** @param press a button went down; one that is down when the gamepad is first seen did not */
  constructor(
    private readonly pilot: Pilot,
    private readonly press: (button: Button) => void,
  ) {}

  /** Look for gamepads. Returns what ends it. */
  readonly start = (): (() => void) => {
    let watching: 'idle' | 'loading' | 'over' | (() => void) = 'idle';
    const load = async () => {
      const { watchPads } = await import('./padWatch');
      if (watching === 'loading') watching = watchPads(this.pilot, this.press, (news) => Object.assign(this, news));
    };
    const begin = () => {
      if (watching !== 'idle') return;
      watching = 'loading';
      load().catch(() => {
        this.notice = texts.gamepad.notLoaded;
      });
    };
    if (!('getGamepads' in navigator)) this.notice = texts.gamepad.insecure;
    else if (navigator.getGamepads().some((pad) => pad?.connected)) begin();
    window.addEventListener('gamepadconnected', begin);
    return () => {
      window.removeEventListener('gamepadconnected', begin);
      if (typeof watching === 'function') watching();
      watching = 'over';
      this.name = this.index = null;
    };
  };

  /** Let the gamepad in use be felt, where it can. */
  vibrate(how: Vibration): void {
    if (this.index !== null) vibrate(navigator.getGamepads()[this.index], how);
  }
}
