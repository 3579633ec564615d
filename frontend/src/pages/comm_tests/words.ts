/** Names and numbers of tests in words. */
import type { CommTestSummary } from '../../api';
import { MISSING } from '../../format';
import { commTests as texts } from '../../texts/comm_tests';

const FRAMINGS: Readonly<Record<string, { readonly name: string }>> = texts.framings;

/** The framing and the direction of a run. */
export function aboutRun(run: Pick<CommTestSummary, 'framing' | 'direction'>): string {
  return texts.method(FRAMINGS[run.framing]?.name ?? run.framing, texts.directions[run.direction].name);
}

/** A rate as the thesis prints it. */
export function rateText(rate: number | null | undefined): string {
  return rate === null || rate === undefined ? MISSING : rate.toFixed(2);
}

/** A difference of rates, always with its sign. */
export function differenceText(difference: number | null): string {
  if (difference === null) return MISSING;
  const digits = Math.abs(difference).toFixed(2);
  if (Number(digits) === 0) return `\u00b1${digits}`;
  return `${difference < 0 ? '\u2212' : '+'}${digits}`;
}

/** How often each cause occurs among the cells, the most frequent first. */
export function countCauses(cells: readonly { readonly causes: readonly string[] }[]): [string, number][] {
  const counts = new Map<string, number>();
  for (const cause of cells.flatMap(({ causes }) => causes)) counts.set(cause, (counts.get(cause) ?? 0) + 1);
  return [...counts].sort(([, one], [, other]) => other - one);
}
