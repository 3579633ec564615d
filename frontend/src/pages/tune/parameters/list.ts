/** How parameters are found, grouped, checked and compared. */
import type { ParameterValue } from '../../../api';
import type { Loop, TunableParameter } from '../../../generated/topics';
import { hasWords } from '../../../searching';
import { tune as texts } from '../../../texts/tune';

export interface Group {
  readonly name: string;
  readonly parameters: readonly TunableParameter[];
}

export interface Difference {
  readonly name: string;
  /** null where that side has no such parameter */
  readonly left: ParameterValue | null;
  readonly right: ParameterValue | null;
}

/** Those with each word in name, meaning or unit; with `changed` only those that are not at their default. */
export function find(parameters: readonly TunableParameter[], search: string, changed: boolean): TunableParameter[] {
  return parameters.filter((one) => {
    const text = `${one.name} ${one.meaning} ${one.unit}`;
    return hasWords(text, search) && (!changed || one.value !== one.default);
  });
}

/** By all of the name but its last word, in the order in which they come. */
export function group(parameters: readonly TunableParameter[]): Group[] {
  const groups = new Map<string, TunableParameter[]>();
  for (const one of parameters) {
    const name = one.name.slice(0, one.name.lastIndexOf('.'));
    groups.set(name, [...(groups.get(name) ?? []), one]);
  }
  return [...groups].map(([name, members]) => ({ name, parameters: members }));
}

/** Why the runtime would refuse this value; null where it would not. */
export function wrong(parameter: TunableParameter, value: ParameterValue): string | null {
  if (parameter.type === 'choice') return parameter.choices.includes(String(value)) ? null : texts.parameters.noSuchChoice;
  if (parameter.type === 'switch') return null;
  if (typeof value !== 'number' || Number.isNaN(value)) return texts.parameters.notNumber;
  if (parameter.type === 'whole' && !Number.isInteger(value)) return texts.parameters.notWhole;
  const { minimum, maximum } = parameter;
  return minimum !== null && maximum !== null && value >= minimum && value <= maximum ? null : texts.parameters.outOfRange;
}

/** As a person reads it; six digits tell more than anybody can set. */
export function words(value: ParameterValue | null): string {
  if (value === null) return '–';
  if (typeof value === 'boolean') return value ? texts.parameters.on : texts.parameters.off;
  return typeof value === 'number' ? String(Number(value.toPrecision(6))) : value.replaceAll('_', ' ');
}

/** What people call a loop's controller; null where the robot has no such one. */
export function controllerTitle(loops: readonly Loop[], loop: string | undefined, name: ParameterValue | undefined | null): string | null {
  return loops.find((one) => one.name === loop)?.controllers.find((one) => one.name === name)?.title ?? null;
}

/** The value of the parameter of this name as a person reads it: a controller by its title. */
export function valueWords(loops: readonly Loop[], name: string, value: ParameterValue | null): string {
  const [loop, what] = name.split('.');
  return (what === 'controller' ? controllerTitle(loops, loop, value) : null) ?? words(value);
}

/** What a group of parameters is called: a controller's by its title. */
export function groupTitle(loops: readonly Loop[], name: string): string {
  const [loop, ...inner] = name.split('.');
  return [loop, ...inner.map((one) => controllerTitle(loops, loop, one) ?? one)].join(' · ').replaceAll('_', ' ');
}

/** What is not the same on both sides, in the order of the left one. */
export function differences(
  left: Readonly<Record<string, ParameterValue>>,
  right: Readonly<Record<string, ParameterValue>>,
): Difference[] {
  return [...new Set([...Object.keys(left), ...Object.keys(right)])]
    .map((name) => ({ name, left: left[name] ?? null, right: right[name] ?? null }))
    .filter((one) => one.left !== one.right);
}
