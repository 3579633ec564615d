/** What of a sweep is looked at: a figure over one parameter or two, and what holds for the others. */
import type { FigureMeaning, SweepDetail, SweepParameter, SweepVariant } from '../../../api';

export type Value = number | string;

/** A parameter that takes several values, and its place among all of them. */
export interface Axis {
  readonly place: number;
  readonly parameter: SweepParameter;
  /** numbers from the least on, words in the document's order */
  readonly values: readonly Value[];
  /** drawn by chance or by a search: hardly two variants share a value */
  readonly scattered: boolean;
}

/** In the address for the order in which a search tried its variants, and for the figure itself. */
export const ORDER = 'order';
export const FIGURE = 'figure';

export interface Plane {
  readonly figure: FigureMeaning;
  /** null: the order of the variants */
  readonly across: Axis | null;
  /** null: the figure */
  readonly up: Axis | null;
  /** of parameters that are no axis here; one that has no value stands for the best of all */
  readonly fixed: ReadonlyMap<string, Value>;
}

/** A place of the heat map. */
export interface Cell {
  readonly x: Value;
  readonly y: Value;
  /** the best of those that lie here, or the first where none has the figure; null where none was run */
  readonly variant: SweepVariant | null;
  /** variants that lie here */
  readonly variants: number;
  /** runs of theirs that failed */
  readonly failed: number;
}

/** The parameters that can be an axis: those with two values and more, of a list or a range also before all have been run. */
export function axesOf({ parameters, variants }: Pick<SweepDetail, 'parameters' | 'variants'>): Axis[] {
  return parameters.flatMap((parameter, place) => {
    const scattered = parameter.kind === 'random' || parameter.kind === 'search';
    const found = scattered ? variants.map(({ values }) => values[place]) : parameter.values;
    const values = [...new Set(found.filter((value) => value !== null && value !== undefined))];
    return values.length < 2 ? [] : [{ place, parameter, values: inOrder(values), scattered }];
  });
}

function inOrder(values: readonly Value[]): readonly Value[] {
  return values.every((value) => typeof value === 'number') ? [...values].sort((one, other) => one - other) : values;
}

/** The plane that an address asks for; where it asks for nothing, or for what is not there, the one that tells most. */
export function planeOf(detail: SweepDetail, axes: readonly Axis[], seen: ReadonlyMap<string, string>): Plane | null {
  const figure = detail.figures.find(({ name }) => name === seen.get('figure')) ?? detail.figures.find(({ name }) => name === detail.best_figure) ?? detail.figures[0];
  if (figure === undefined) return null;
  const named = (name: string) => axes.find(({ parameter }) => parameter.name === seen.get(name));
  const [first] = axes;
  const searched = axes.some(({ parameter }) => parameter.kind === 'search');
  const across = seen.get('x') === ORDER ? null : (named('x') ?? (searched ? null : first));
  const grid = axes.filter(({ scattered }) => !scattered);
  const second = across?.scattered === false ? grid.find((axis) => axis !== across) : undefined;
  const asked = named('y');
  const up = across === null || across === undefined || seen.get('y') === FIGURE ? null : asked !== undefined && asked !== across ? asked : (second ?? null);
  return { figure, across: across ?? null, up, fixed: readFixed(seen.get('fix') ?? '', axes, [across, up]) };
}

/** `name:value,name:value` of parameters that are neither of these axes. */
function readFixed(text: string, axes: readonly Axis[], taken: readonly (Axis | null | undefined)[]): Map<string, Value> {
  const fixed = new Map<string, Value>();
  for (const entry of text.split(',')) {
    const colon = entry.lastIndexOf(':');
    const axis = axes.find(({ parameter }) => parameter.name === entry.slice(0, colon));
    const value = axis?.values.find((one) => String(one) === entry.slice(colon + 1));
    if (axis !== undefined && value !== undefined && !taken.includes(axis)) fixed.set(axis.parameter.name, value);
  }
  return fixed;
}

/** The same for the address; null where nothing is fixed. */
export function writeFixed(fixed: readonly (readonly [string, Value])[]): string | null {
  return fixed.length === 0 ? null : fixed.map(([name, value]) => `${name}:${value}`).join(',');
}

/** The variants that have the fixed values. */
export function withFixed(variants: readonly SweepVariant[], axes: readonly Axis[], fixed: Plane['fixed']): SweepVariant[] {
  const held = axes.flatMap(({ place, parameter: { name } }) => (fixed.has(name) ? [[place, fixed.get(name)] as const] : []));
  return variants.filter(({ values }) => held.every(([place, value]) => values[place] === value));
}

/** The variant to show: the chosen one, else the best by now; null where neither is there. */
export function shownVariant({ variants, best }: Pick<SweepDetail, 'variants' | 'best'>, chosen: number | null): SweepVariant | null {
  return variants.find(({ number }) => number === chosen) ?? variants.find(({ number }) => number === best?.variant) ?? null;
}

export const meanOf = (variant: SweepVariant, figure: string): number | null => variant.figures[figure]?.mean ?? null;

/** How good a value is: the less the better; null where no value is better than another. */
export function rankOf(value: number, { better }: Pick<FigureMeaning, 'better'>): number | null {
  return better === 'neither' ? null : better === 'zero' ? Math.abs(value) : value;
}

/** The heat map: rows from the greatest value of the axis up on, each from the least of the one across. */
export function heatMap(variants: readonly SweepVariant[], across: Axis, up: Axis, figure: FigureMeaning): Cell[][] {
  const there = new Map<Value, Map<Value, SweepVariant[]>>();
  for (const variant of variants) {
    const [x, y] = [variant.values[across.place], variant.values[up.place]];
    if (x === null || x === undefined || y === null || y === undefined) continue;
    const row = there.get(y) ?? new Map<Value, SweepVariant[]>();
    there.set(y, row);
    row.set(x, [...(row.get(x) ?? []), variant]);
  }
  const cell = (x: Value, y: Value): Cell => {
    const found = there.get(y)?.get(x) ?? [];
    return { x, y, variant: bestVariant(found, figure) ?? found[0] ?? null, variants: found.length, failed: found.reduce((sum, { failed }) => sum + failed, 0) };
  };
  return [...up.values].reverse().map((y) => across.values.map((x) => cell(x, y)));
}

/** The variant of the best mean, the first of equal ones; where no value is better, the first that has one. */
export function bestVariant(variants: readonly SweepVariant[], figure: FigureMeaning): SweepVariant | null {
  let best: SweepVariant | null = null;
  let least = Infinity;
  for (const variant of variants) {
    const mean = meanOf(variant, figure.name);
    if (mean === null) continue;
    const rank = rankOf(mean, figure) ?? 0;
    if (rank < least) [best, least] = [variant, rank];
  }
  return best;
}

/** The least prefix is dropped as long as names stay apart: kp and kd of control.gains.pid. */
export function shortNames(names: readonly string[]): ReadonlyMap<string, string> {
  const tail = (name: string, parts: number) => name.split('.').slice(-parts).join('.');
  return new Map(
    names.map((name) => {
      const whole = name.split('.').length;
      let parts = 1;
      while (parts < whole && names.some((other) => other !== name && tail(other, parts) === tail(name, parts))) parts += 1;
      return [name, tail(name, parts)];
    }),
  );
}
