/** What an experiment is to be, in the shown unit, as the forms hold it and the server takes it. */
import type { LoopName, StepStart, TuningStart } from '../../../api';
import { tune as texts } from '../../../texts/tune';
import { loopOf, type Loop } from './loops';

export interface StepForm {
  start: number;
  target: number;
  tolerance: number;
  settle: number;
  duration: number;
  low: number;
  high: number;
}

export interface RelayForm {
  set_point: number;
  amplitude: number;
  hysteresis: number;
  cycles: number;
  duration: number;
  low: number;
  high: number;
}

export interface FieldSpec<Name> {
  readonly name: Name;
  readonly label: string;
  /** null: the loop's own */
  readonly unit: string | null;
  /** null: as set points of the loop */
  readonly range: readonly [number, number] | null;
  readonly hint: string;
  readonly whole?: boolean;
}

/** The range of a field's numbers, in the loop's unit. */
export function rangeOf({ range }: FieldSpec<string>, loop: Loop): readonly [number, number] {
  return range ?? [loop.least, loop.most];
}

/** Whether each number can be used. */
export function inRange<Name extends string>(values: Readonly<Record<Name, number>>, fields: readonly FieldSpec<Name>[], loop: Loop): boolean {
  return fields.every((field) => {
    const [least, most] = rangeOf(field, loop);
    return values[field.name] >= least && values[field.name] <= most;
  });
}

export const STEP_FIELDS: readonly FieldSpec<keyof StepForm>[] = [
  { name: 'start', ...texts.fields.start, unit: null, range: null },
  { name: 'target', ...texts.fields.target, unit: null, range: null },
  { name: 'duration', ...texts.fields.stepDuration, unit: 's', range: [2, 300] },
];

export const STEP_MORE: readonly FieldSpec<keyof StepForm>[] = [
  { name: 'tolerance', ...texts.fields.tolerance, unit: null, range: [0.001, 20] },
  { name: 'settle', ...texts.fields.settle, unit: 's', range: [0, 120] },
  { name: 'low', ...texts.fields.low, unit: null, range: [-180, 180] },
  { name: 'high', ...texts.fields.high, unit: null, range: [-180, 180] },
];

export const RELAY_FIELDS: readonly FieldSpec<keyof RelayForm>[] = [
  { name: 'set_point', ...texts.fields.centre, unit: null, range: null },
  { name: 'amplitude', ...texts.fields.amplitude, unit: '%', range: [10, 100] },
  { name: 'cycles', ...texts.fields.cycles, unit: '', range: [3, 20], whole: true },
];

export const RELAY_MORE: readonly FieldSpec<keyof RelayForm>[] = [
  { name: 'hysteresis', ...texts.fields.hysteresis, unit: null, range: [0, 20] },
  { name: 'duration', ...texts.fields.relayDuration, unit: 's', range: [2, 300] },
  { name: 'low', ...texts.fields.low, unit: null, range: [-180, 180] },
  { name: 'high', ...texts.fields.high, unit: null, range: [-180, 180] },
];

export function usualStep(loop: LoopName): StepForm {
  if (loop === 'depth') return { start: 0.4, target: 0.7, tolerance: 0.03, settle: 20, duration: 12, low: 0, high: 1.5 };
  if (loop === 'heading') return { start: 0, target: 30, tolerance: 4, settle: 20, duration: 12, low: -90, high: 120 };
  return { start: 0, target: 10, tolerance: 3, settle: 20, duration: 12, low: -40, high: 40 };
}

export function usualRelay(loop: LoopName): RelayForm {
  if (loop === 'depth') return { set_point: 0.6, amplitude: 50, hysteresis: 0.01, cycles: 4, duration: 120, low: 0, high: 1.5 };
  const limits = loop === 'heading' ? { low: -90, high: 90 } : { low: -40, high: 40 };
  return { set_point: 0, amplitude: 50, hysteresis: 1, cycles: 4, duration: 120, ...limits };
}

export function stepStart(loop: LoopName, form: StepForm): StepStart {
  const { factor } = loopOf(loop);
  const { settle, duration, ...values } = form;
  const own = Object.fromEntries(Object.entries(values).map(([name, value]) => [name, value / factor])) as typeof values;
  return { kind: 'step', loop, settle, duration, ...own };
}

export function relayStart(loop: LoopName, form: RelayForm): TuningStart {
  const { factor } = loopOf(loop);
  const { amplitude, cycles, duration, ...values } = form;
  const own = Object.fromEntries(Object.entries(values).map(([name, value]) => [name, value / factor])) as typeof values;
  return { kind: 'relay', loop, amplitude: amplitude / 100, cycles, duration, ...own };
}
