/** Figures of sessions: the best of several, and their text. */
import type { FigureMark, FigureMeaning } from '../api';
import { fixed, MISSING } from '../format';

/** The place in the depth chart that a figure of the table is read from. */
export interface Pointed {
  readonly session: number;
  readonly mark: FigureMark;
}

type Value = number | null;

/** Places of the best values; none where all look alike, or where no value is better than another. */
export function bestOf(values: readonly Value[], meaning: Pick<FigureMeaning, 'better' | 'decimals'>): Set<number> {
  const ranks = values.map((value) => (value === null ? null : Number((meaning.better === 'zero' ? Math.abs(value) : value).toFixed(meaning.decimals))));
  const there = ranks.filter((rank) => rank !== null);
  const least = Math.min(...there);
  if (meaning.better === 'neither' || there.length < 2 || there.every((rank) => rank === least)) return new Set();
  return new Set(ranks.flatMap((rank, place) => (rank === least ? [place] : [])));
}

export function figureText(value: Value, decimals: number): string {
  return value === null ? MISSING : fixed(value, decimals);
}
