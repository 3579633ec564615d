/** The figures of a dry run. */
import type { MissionTrial, MissionTrialResult } from '../../api';

export type Outcome = 'succeeded' | 'failed' | 'ended' | 'none';

/** A step at which runs failed. `place` is empty where it is the mission itself. */
interface Failure {
  readonly place: string;
  readonly count: number;
  /** of the first of these runs */
  readonly text: string;
}

interface TrialFigures {
  readonly succeeded: number;
  /** least and most, s; of the runs that succeeded */
  readonly took: readonly [number, number] | null;
  /** m, of all runs */
  readonly deepest: number;
  readonly failures: readonly Failure[];
}

export function outcomeOf({ phase }: MissionTrialResult): Outcome {
  return phase === null ? 'none' : phase === 'succeeded' || phase === 'failed' ? phase : 'ended';
}

export function figuresOf({ results }: MissionTrial): TrialFigures {
  const good = results.filter((one) => one.phase === 'succeeded').map(({ elapsed }) => elapsed);
  const failures = new Map<string, Failure>();
  for (const { phase, failed, text } of results) {
    if (phase === 'succeeded') continue;
    const place = failed ?? '';
    const before = failures.get(place);
    failures.set(place, { place, count: (before?.count ?? 0) + 1, text: before?.text ?? text });
  }
  return {
    succeeded: good.length,
    took: good.length === 0 ? null : [Math.min(...good), Math.max(...good)],
    deepest: Math.max(0, ...results.map((one) => one.deepest)),
    failures: [...failures.values()].sort((one, other) => other.count - one.count),
  };
}

/** Round figures from 0 to `most`, at most `count` steps apart. */
export function ticks(most: number, count: number): number[] {
  const rough = Math.max(most, 1e-6) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((one) => one * power >= rough) ?? 10);
  return Array.from({ length: Math.floor(most / step + 1e-9) + 1 }, (_, index) => Number((index * step).toFixed(6)));
}
