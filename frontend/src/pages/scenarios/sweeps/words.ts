/** A sweep's values and results in words. */
import type { FigureInterval, FigureMeaning, RankedBest, SweepParameter, SweepVariant } from '../../../api';
import { fixed, MISSING } from '../../../format';
import { sweeps as texts } from '../../../texts/sweeps';
import type { Value } from './plane';

/** digits of a parameter's value: more tell nothing, and a search gives fifteen */
const DIGITS = 4;

export const valueText = (value: Value | null | undefined): string =>
  value === null || value === undefined ? texts.bySeed : typeof value === 'number' ? String(Number(value.toPrecision(DIGITS))).replace('-', '\u2212') : value;

/** A figure with its unit. */
export function withUnit(value: number | null, { decimals, unit }: Pick<FigureMeaning, 'decimals' | 'unit'>): string {
  if (value === null) return MISSING;
  return unit === '' ? fixed(value, decimals) : `${fixed(value, decimals)} ${unit}`;
}

/** A mean with the interval in which it lies. */
export function meanWords(one: FigureInterval | undefined, figure: FigureMeaning): string {
  if (one === undefined) return MISSING;
  const { mean, low, high } = one;
  return low === null || high === null ? withUnit(mean, figure) : texts.mean(withUnit(mean, figure), fixed(low, figure.decimals), fixed(high, figure.decimals));
}

/** kp 3, kd 0.5 */
export const valuesWords = (variant: Pick<SweepVariant, 'values'>, parameters: readonly Pick<SweepParameter, 'name'>[], names: ReadonlyMap<string, string>): string =>
  parameters.map(({ name }, place) => `${names.get(name) ?? name} ${valueText(variant.values[place])}`).join(', ');

/** How sure it is that the best is better than the next: by the differences of runs with equal seeds. */
export function bestWords({ next }: Pick<RankedBest, 'next'>, figure: FigureMeaning): string {
  if (next === null) return texts.best.alone;
  const { difference, low, high } = next;
  if (low === null || high === null) return texts.best.oneSeed(next.variant, withUnit(Math.abs(difference), figure));
  if (low <= 0 && high >= 0) return texts.best.notApart(next.variant);
  const [least, most] = [Math.abs(low), Math.abs(high)].sort((one, other) => one - other) as [number, number];
  return texts.best.better(next.variant, withUnit(Math.abs(difference), figure), fixed(least, figure.decimals), fixed(most, figure.decimals));
}

/** values of a list that are written one by one */
const LISTED = 8;

/** What a parameter takes: each value, or from the least to the greatest. */
export function valuesText({ values, kind, unit }: Pick<SweepParameter, 'values' | 'kind' | 'unit'>): string {
  const numbers = values.filter((value) => typeof value === 'number');
  const [least, most] = [valueText(Math.min(...numbers)), valueText(Math.max(...numbers))];
  const words = kind === 'random' || kind === 'search' ? texts.span(least, most) : values.length > LISTED ? texts.edit.steps(least, most, values.length) : values.map(valueText).join(', ');
  return unit === '' ? words : `${words} ${unit}`;
}
