/** The picture of a plan: the room of times and depths, and the line of each step. */
import type { MissionPlanned, MissionTrial } from '../../api';

type PlannedStep = MissionPlanned['steps'][number];

/** s between two points of a trial's curve */
export const CURVE_PERIOD = 0.5;

export interface Span {
  /** s */
  readonly time: number;
  /** m */
  readonly depth: number;
}

/** The greatest time and depth that plan, runs and limit need; the limit only where it is near. */
export function spanOf(steps: readonly PlannedStep[], trial: MissionTrial | null, limit: number): Span {
  const results = trial?.results ?? [];
  const deepest = Math.max(0.5, ...steps.map((step) => Math.max(step.start_depth, step.end_depth)), ...results.map((one) => one.deepest));
  return {
    time: Math.max(1, ...steps.map(({ end }) => end), ...results.map(({ elapsed }) => elapsed)),
    depth: 1.06 * (limit < 2 * deepest ? Math.max(limit, deepest) : deepest),
  };
}

/** True where a place is that of a step, or of one below it: 3.1 of 3, and every one of the whole mission. */
export const isWithin = (place: string, step: string): boolean => step === '' || place === step || place.startsWith(`${step}.`);

/** One of several steps of the same time stands in the row below the others. */
export function rowsOf(steps: readonly PlannedStep[]): readonly number[] {
  const ends: number[] = [];
  return steps.map(({ start, end }) => {
    const free = ends.findIndex((one) => one <= start + 1e-9);
    const row = free < 0 ? ends.length : free;
    ends[row] = end;
    return row;
  });
}
