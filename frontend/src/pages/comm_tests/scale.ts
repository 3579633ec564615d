/** Colours of cells. A rate has the same one on every chart and in both themes. */
import { mixedPaint } from '../../charts/shades';
import type { Paint } from '../../parts/table';

/** Viridis of matplotlib, 0 to 1: told apart by colour-blind eyes, and growing lighter all the way. */
const VIRIDIS = [
  '#440154', '#482475', '#414487', '#355f8d', '#2a788e', '#21918c', '#22a884', '#44bf70', '#7ad151', '#bddf26', '#fde725',
] as const;

/** Of a rate from 0 to 1. */
export function ratePaint(rate: number): Paint {
  return mixedPaint(VIRIDIS, rate);
}

/** Of a difference from -1 to 1: `worse` at -1, `equal` at 0, `better` at 1 (hex colours). */
export function differencePaint(difference: number, worse: string, equal: string, better: string): Paint {
  return mixedPaint([worse, equal, better], (difference + 1) / 2);
}

export const RATE_GRADIENT = `linear-gradient(to right, ${VIRIDIS.join(', ')})`;
