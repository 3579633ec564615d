import type { TuningRun } from '../../../api';

/** A run by its number, which no other has, and its name. */
export function runTitle(run: Pick<TuningRun, 'id' | 'name'>): string {
  return `#${run.id} ${run.name}`;
}

/** A gain with as many digits as are worth reading. */
export function gainText(value: number): string {
  return String(Number(value.toPrecision(3)));
}

/** A controller with its gains, in a line. */
export function forceWords(force: TuningRun['force']): string {
  const gains = Object.entries(force.gains).map(([name, value]) => `${name.replaceAll('_', ' ')} ${gainText(value)}`);
  return [force.title, ...gains].join(', ');
}
