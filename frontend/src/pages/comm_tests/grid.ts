/** Places of a test's grid: a baud rate (bit/s), the Arduino's and the Pi's delay after each number (s). */
import { commTests as texts } from '../../texts/comm_tests';

export interface Place {
  readonly baud: number;
  readonly arduino_delay: number;
  readonly pi_delay: number;
}

export interface Grid {
  readonly bauds: readonly number[];
  readonly arduinoDelays: readonly number[];
  readonly piDelays: readonly number[];
}

export const key = ({ baud, arduino_delay, pi_delay }: Place): string => `${baud} ${arduino_delay} ${pi_delay}`;

/** A place in words: 9600 baud, Arduino 0.5 s, Pi 0 s. */
export const placeWords = ({ baud, arduino_delay, pi_delay }: Place): string =>
  texts.place(baud, arduino_delay, pi_delay);

/** Every value that occurs along each side, the least first. */
export function gridOf(places: readonly Place[]): Grid {
  return {
    bauds: sorted(places.map(({ baud }) => baud)),
    arduinoDelays: sorted(places.map(({ arduino_delay }) => arduino_delay)),
    piDelays: sorted(places.map(({ pi_delay }) => pi_delay)),
  };
}

const sorted = (values: readonly number[]) => [...new Set(values)].sort((one, other) => one - other);

/** Places in the order of `gridOf`. */
export function byPlace(one: Place, other: Place): number {
  return one.baud - other.baud || one.arduino_delay - other.arduino_delay || one.pi_delay - other.pi_delay;
}

/** The places of a run's document, in the order in which its cells are numbered. */
export function placesOf(document: Readonly<Record<string, unknown>>): Place[] {
  const list = (name: string) => (Array.isArray(document[name]) ? (document[name] as number[]) : []);
  return list('baud_rate').flatMap((baud) =>
    list('arduinodelay').flatMap((arduino_delay) => list('delay').map((pi_delay) => ({ baud, arduino_delay, pi_delay }))),
  );
}

/** How many facets `wide` px each (with `gap` between) stand side by side in `width` px: all in one row, or rows as even as can be. */
export function facetColumns(facets: number, width: number, wide: number, gap: number): number {
  const most = Math.max(1, Math.floor((width + gap) / (wide + gap)));
  const rows = Math.ceil(facets / most);
  return Math.max(1, Math.ceil(facets / rows));
}
