/** A sweep's values and results in words. */
import type { FigureInterval, FigureMeaning, RankedBest, SweepParameter, SweepVariant } from '../../../api';
import { fixed, MISSING } from '../../../format';
import { sweeps as texts } from '../../../texts/sweeps';
import type { Value } from './plane';

/** digits of a parameter's value: more tell nothing, and a search gives fifteen */
const DIGITS = 4;
const DECIMALS_MOST = 8;

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

/**
 * How sure it is that the best is better than the next, whose mean is `other`: by the differences of runs with equal seeds.
 * These may be sure where the intervals of the means overlap, since a seed shifts all variants alike.
 */
export function bestWords({ low: from, high: to, next }: Omit<RankedBest, 'variant' | 'mean'>, figure: FigureMeaning, other?: FigureInterval): string {
  if (next === null) return texts.best.alone;
  const { variant, difference, low, high } = next;
  const shown = { unit: figure.unit, decimals: Math.max(figure.decimals, decimalsOf(difference)) };
  if (low === null || high === null) return texts.best.oneSeed(variant, withUnit(difference, shown));
  if (low === 0 && high === 0) return texts.best.equal(variant);
  const least = fixed(low, shown.decimals);
  if (low <= 0) return texts.best.notApart(variant, least, withUnit(high, shown));
  const words = texts.best.better(variant, withUnit(difference, shown), least, withUnit(high, shown));
  const overlap = [from, to, other?.low, other?.high].every((end) => typeof end === 'number') && Number(from) <= Number(other?.high) && Number(other?.low) <= Number(to);
  return overlap ? `${words} ${texts.best.overlap}` : words;
}

/** The decimals by which a difference is not written as 0. */
const decimalsOf = (difference: number): number => (difference === 0 ? 0 : Math.min(Math.ceil(-Math.log10(Math.abs(difference))), DECIMALS_MOST));

/** values of a list that are written one by one */
const LISTED = 8;

/** What a parameter takes: each value, or from the least to the greatest. */
export function valuesText({ values, kind, unit }: Pick<SweepParameter, 'values' | 'kind' | 'unit'>): string {
  const numbers = values.filter((value) => typeof value === 'number');
  const [least, most] = [valueText(Math.min(...numbers)), valueText(Math.max(...numbers))];
  const words = kind === 'random' || kind === 'search' ? texts.span(least, most) : values.length > LISTED ? texts.edit.steps(least, most, values.length) : values.map(valueText).join(', ');
  return unit === '' ? words : `${words} ${unit}`;
}
