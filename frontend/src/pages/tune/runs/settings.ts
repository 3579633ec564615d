/** What an experiment is to be, in the shown unit, as the forms hold it and the server takes it. */
import type { LoopName, TuningStart } from '../../../api';
import { loopOf } from './loops';

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
}

export const STEP_FIELDS: readonly FieldSpec<keyof StepForm>[] = [
  { name: 'start', label: 'from', unit: null, range: null, hint: 'Held until the value rests there' },
  { name: 'target', label: 'to', unit: null, range: null, hint: 'The set point after the step' },
  { name: 'duration', label: 'measured for', unit: 's', range: [2, 300], hint: 'From the step on' },
];

export const STEP_MORE: readonly FieldSpec<keyof StepForm>[] = [
  { name: 'tolerance', label: 'rests within ±', unit: null, range: [0.001, 20], hint: 'So near to the start, for 2 s, counts as rest' },
  { name: 'settle', label: 'waits at most', unit: 's', range: [0, 120], hint: 'For the value to rest at the start; then the step comes anyway' },
  { name: 'low', label: 'not below', unit: null, range: [-180, 180], hint: 'Beyond, the experiment ends at once' },
  { name: 'high', label: 'not above', unit: null, range: [-180, 180], hint: 'Beyond, the experiment ends at once' },
];

export const RELAY_FIELDS: readonly FieldSpec<keyof RelayForm>[] = [
  { name: 'set_point', label: 'about', unit: null, range: null, hint: 'The relay switches as the value passes here' },
  { name: 'amplitude', label: 'command ±', unit: '%', range: [10, 100], hint: 'Share of the most command, either way' },
  { name: 'cycles', label: 'cycles', unit: '', range: [3, 20], hint: 'That are measured, once both halves of a cycle are alike' },
];

export const RELAY_MORE: readonly FieldSpec<keyof RelayForm>[] = [
  { name: 'hysteresis', label: 'switches ± beyond', unit: null, range: [0, 20], hint: 'So that noise does not switch it' },
  { name: 'duration', label: 'gives up after', unit: 's', range: [2, 300], hint: 'Where there are not enough cycles by then' },
  { name: 'low', label: 'not below', unit: null, range: [-180, 180], hint: 'Beyond, the experiment ends at once' },
  { name: 'high', label: 'not above', unit: null, range: [-180, 180], hint: 'Beyond, the experiment ends at once' },
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

export function stepStart(loop: LoopName, form: StepForm): TuningStart {
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
