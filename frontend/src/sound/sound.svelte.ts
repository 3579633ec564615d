import { createContext } from 'svelte';
import { readStored, writeStored } from '../storage';

export const VOLUMES = ['off', 'low', 'full'] as const;
export type Volume = (typeof VOLUMES)[number];

const VOLUME = 'mucat-sound';
const SPOKEN = 'mucat-spoken';

/** How loud this page is; remembered on this device. Off at first: several pages may watch one robot in one room. */
export class SoundChoice {
  volume = $state<Volume>(VOLUMES.find((volume) => volume === readStored(VOLUME)) ?? 'off');
  spoken = $state(readStored(SPOKEN) === 'on');
  /** why nothing is heard, in words */
  problem = $state('');
  /** counts what is played to try it */
  tests = $state(0);

  readonly choose = (volume: Volume): void => {
    this.volume = volume;
    writeStored(VOLUME, volume);
    if (volume !== 'off') this.test();
  };

  readonly speak = (spoken: boolean): void => {
    this.spoken = spoken;
    writeStored(SPOKEN, spoken ? 'on' : 'off');
    if (spoken) this.test();
  };

  readonly test = (): void => {
    this.tests += 1;
  };
}

export const [useSound, provideSound] = createContext<SoundChoice>();
