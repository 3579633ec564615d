/** Which share of the way from the worst to the best colour a value has. */
import type { FigureMeaning } from '../../../api';
import { rankOf } from './plane';

export interface Shading {
  /** the value of the best colour, and that of the worst; where no value is better, the greatest and the least */
  readonly best: number;
  readonly worst: number;
  /** some are worse than `worst`, and have its colour */
  readonly clipped: boolean;
  /** 0 worst, 1 best */
  readonly share: (value: number) => number;
}

/** Quartile distances beyond the third quartile after which a value no longer widens the scale: a variant that does not swim at all would leave all others one colour. */
const FAR = 3;

/** The shading of these values; null without one. */
export function shadingOf(values: readonly number[], figure: FigureMeaning): Shading | null {
  if (values.length === 0) return null;
  if (figure.better === 'neither') {
    const [least, most] = [leastOf(values), mostOf(values)];
    return { best: most, worst: least, clipped: false, share: (value) => (most === least ? 1 : (value - least) / (most - least)) };
  }
  const rank = (value: number) => rankOf(value, figure) ?? value;
  const ranks = values.map(rank).sort((one, other) => one - other);
  const at = (share: number) => ranks[Math.round(share * (ranks.length - 1))] ?? 0;
  const [best, most] = [at(0), at(1)];
  const fence = at(0.75) + FAR * (at(0.75) - at(0.25));
  const within = ranks.filter((one) => one <= fence);
  const worst = within.at(-1) ?? most;
  return { best, worst, clipped: worst < most, share: (value) => (worst === best ? 1 : Math.min(1, Math.max(0, (worst - rank(value)) / (worst - best)))) };
}

// Spread over the arguments of a call, tens of thousands of values would be too many.
const leastOf = (values: readonly number[]) => values.reduce((one, other) => Math.min(one, other));
const mostOf = (values: readonly number[]) => values.reduce((one, other) => Math.max(one, other));
