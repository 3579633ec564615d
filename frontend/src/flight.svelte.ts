import { createContext } from 'svelte';
import type { PageName } from './router.svelte';
import { readStored, writeStored } from './storage';

const KEY = 'mucat-flight';

const go = (page: 'flight' | 'operate') => {
  location.hash = `#/${page}`;
};

/** The flight view as the rest of the page knows it: it comes by itself while this page drives by hand, and may be left. */
export class Flight {
  /** whether it comes by itself; remembered on this device */
  byItself = $state(readStored(KEY) !== 'off');
  /** why the screen may go dark; empty where it stays lit, or where nothing asks for that */
  dark = $state('');
  /** px that the bar of states takes at the top */
  bar = $state(0);
  /** whether the bar of states and the notices are hidden: visitors see an exhibit */
  hidden = $state(false);
  #came = false;
  #left = false;
  #page: PageName = 'unknown';

  readonly set = (on: boolean): void => {
    this.byItself = on;
    writeStored(KEY, on ? 'on' : 'off');
  };

  readonly toggle = (): void => go(this.#page === 'flight' ? 'operate' : 'flight');

  /**
   * Come and go with the driving by hand.
   *
   * @param manual whether the robot is armed in manual
   * @param mine whether this page may drive it
   */
  follow(page: PageName, manual: boolean, mine: boolean): void {
    // Whoever has left it is not taken back, until the robot is armed in manual anew.
    if (this.#page === 'flight' && page !== 'flight') this.#left = true;
    this.#page = page;
    if (!manual) {
      if (this.#came && page === 'flight') go('operate');
      this.#came = this.#left = false;
    } else if (this.byItself && mine && page === 'operate' && !this.#left) {
      this.#came = true;
      go('flight');
    }
  }
}

export const [useFlight, provideFlight] = createContext<Flight>();
