import type { Paint } from '../../parts/table';
import { token } from '../../theme.svelte';
import { differencePaint } from './scale';

/** Colours of -1, 0 and 1 in the theme as it stands. */
export function differenceColours(): [string, string, string] {
  return [token('series-wanted'), token('raised'), token('series-measured')];
}

/** Of a cell that was not run. */
export function unpainted(): Paint {
  return { fill: token('well'), ink: token('muted') };
}

export function paintDifference(difference: number): Paint {
  return differencePaint(difference, ...differenceColours());
}
