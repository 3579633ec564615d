import { byPlace, key, type Place } from './grid';

/** What is compared: a run's rates, or those of one of the thesis's tables. */
export interface Column {
  readonly id: string;
  readonly title: string;
  /** what tells it from others: framing, direction, where it ran */
  readonly about: string;
  readonly cells: readonly (Place & { readonly rate: number })[];
}

export interface Row {
  readonly place: Place;
  /** a rate for each column; null where it has no cell there */
  readonly rates: readonly (number | null)[];
  /** what each column is above (positive) or below the first; null where one of the two has no cell there */
  readonly differences: readonly (number | null)[];
}

/** Every place that any column has, with all rates and what they differ by from the first column's. */
export function compare(columns: readonly Column[]): Row[] {
  const rates = columns.map((column) => new Map(column.cells.map((cell) => [key(cell), cell.rate])));
  const places = new Map(columns.flatMap(({ cells }) => cells.map((cell) => [key(cell), cell])));
  return [...places.entries()]
    .map(([at, { baud, arduino_delay, pi_delay }]) => {
      const here = rates.map((column) => column.get(at) ?? null);
      const [first = null] = here;
      return {
        place: { baud, arduino_delay, pi_delay },
        rates: here,
        differences: here.map((rate) => (rate === null || first === null ? null : rate - first)),
      };
    })
    .sort((one, other) => byPlace(one.place, other.place));
}

export interface Summary {
  readonly mean: number | null;
  readonly least: number | null;
  /** cells that both this and the first column have, and of these those more than half a hundredth above and below */
  readonly common: number;
  readonly better: number;
  readonly worse: number;
  /** mean difference from the first column over the common cells */
  readonly difference: number | null;
}

const EQUAL_WITHIN = 0.005;

/** Column `index` of the rows, and how it stands to the first. */
export function summarise(rows: readonly Row[], index: number): Summary {
  const rates = rows.map((row) => row.rates[index]).filter(isNumber);
  const differences = rows.map((row) => row.differences[index]).filter(isNumber);
  return {
    mean: mean(rates),
    least: rates.length > 0 ? Math.min(...rates) : null,
    common: differences.length,
    better: differences.filter((one) => one >= EQUAL_WITHIN).length,
    worse: differences.filter((one) => one <= -EQUAL_WITHIN).length,
    difference: mean(differences),
  };
}

const isNumber = (value: number | null | undefined): value is number => typeof value === 'number';

function mean(values: readonly number[]): number | null {
  return values.length > 0 ? values.reduce((sum, one) => sum + one, 0) / values.length : null;
}
