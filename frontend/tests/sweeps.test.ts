import { describe, expect, it } from 'vitest';
import type { FigureMeaning, SweepDetail, SweepParameter, SweepVariant } from '../src/api';
import { drawChart, type Drawing } from '../src/pages/scenarios/sweeps/chart';
import { axesOf, bestVariant, FIGURE, heatMap, ORDER, planeOf, shortNames, shownVariant, withFixed, writeFixed, type Value } from '../src/pages/scenarios/sweeps/plane';
import { shadingOf } from '../src/pages/scenarios/sweeps/shading';
import { bestWords, meanWords, valuesText, valuesWords, valueText } from '../src/pages/scenarios/sweeps/words';

const RMSE: FigureMeaning = { name: 'rmse', title: 'RMSE', unit: 'm', decimals: 4, better: 'less', meaning: '' };
const ERROR: FigureMeaning = { ...RMSE, name: 'steady_error', title: 'Steady error', better: 'zero' };
const PERIOD: FigureMeaning = { ...RMSE, name: 'cycle_period', better: 'neither' };
const KP = 'control.gains.pid.kp';
const KD = 'control.gains.pid.kd';
const WATER = 'scene.kind';

const parameter = (name: string, kind: SweepParameter['kind'] = 'list', values: Value[] = []): SweepParameter => ({ name, label: name, unit: '', values, kind, by_seed: false });
const measured = (mean: number, low: number | null = mean - 0.01, high: number | null = mean + 0.01) => ({ mean, low, high, count: 3 });
const variant = (number: number, values: (Value | null)[], rmse: number | null, failed = 0): SweepVariant =>
  ({ number, values, runs: 3, failed, within: true, figures: rmse === null ? {} : { rmse: measured(rmse), steady_error: measured(-rmse) } });

const VARIANTS = [
  variant(1, [3, 0.5, 'pool'], 0.05),
  variant(2, [3, 1, 'pool'], 0.03),
  variant(3, [10, 0.5, 'pool'], 0.04),
  variant(4, [10, 1, 'pool'], null, 3),
  variant(5, [3, 0.5, 'natural'], 0.02),
];
const sweep = (variants: SweepVariant[], parameters: SweepParameter[]): SweepDetail =>
  ({ parameters, variants, figures: [RMSE, ERROR], best_figure: 'rmse', best: null }) as unknown as SweepDetail;
const GRID = sweep(VARIANTS, [parameter(KP, 'list', [10, 3]), parameter(KD, 'list', [0.5, 1]), parameter(WATER, 'list', ['pool', 'natural'])]);
const AXES = axesOf(GRID);
const seen = (entries: Record<string, string>) => new Map(Object.entries(entries));
const plane = (entries: Record<string, string> = {}) => planeOf(GRID, AXES, seen(entries));

describe('the axes of a sweep', () => {
  it('are what varies, numbers in order, words as they came', () => {
    expect(AXES.map(({ values }) => values)).toEqual([[3, 10], [0.5, 1], ['pool', 'natural']]);
    // Before the first run, too; what each seed draws for itself is none.
    expect(axesOf({ ...GRID, variants: [] })).toEqual(AXES);
    expect(axesOf(sweep([variant(1, [1, null], 1)], [parameter(KP, 'list', [1, 2]), parameter(KD, 'random', [0, 1])])).map(({ place }) => place)).toEqual([0]);
  });

  it('are the first two, until an address names others', () => {
    expect(plane()).toMatchObject({ figure: RMSE, across: AXES[0], up: AXES[1] });
    expect(plane({ figure: 'steady_error', x: KD, y: KP })).toMatchObject({ figure: ERROR, across: AXES[1], up: AXES[0] });
    expect(plane({ y: FIGURE })).toMatchObject({ across: AXES[0], up: null });
    // What is not there is as if it was not named.
    expect(plane({ figure: 'x', x: 'y', y: 'z', fix: 'a:1' })).toMatchObject({ figure: RMSE, across: AXES[0], up: AXES[1] });
    expect(plane({ x: KD, y: KD })).toMatchObject({ across: AXES[1], up: AXES[0] });
  });

  it('show a search in the order of its trials, and what is drawn by chance as dots', () => {
    const search = sweep([variant(1, [0.3], 1), variant(2, [0.7], 2)], [parameter(KP, 'search')]);
    expect(planeOf(search, axesOf(search), seen({}))).toMatchObject({ across: null, up: null });
    expect(planeOf(search, axesOf(search), seen({ x: KP }))?.across?.scattered).toBe(true);
    const random = sweep([variant(1, [0.3, 1], 1), variant(2, [0.7, 2], 2)], [parameter(KP, 'random'), parameter(KD, 'random')]);
    expect(planeOf(random, axesOf(random), seen({}))).toMatchObject({ across: { place: 0 }, up: null });
    expect(planeOf(random, axesOf(random), seen({ x: ORDER }))).toMatchObject({ across: null, up: null });
  });

  it('hold what an address fixes, unless it is an axis', () => {
    const held = plane({ fix: `${WATER}:natural,${KP}:3` });
    expect([...(held?.fixed ?? [])]).toEqual([[WATER, 'natural']]);
    expect(writeFixed([...(held?.fixed ?? [])])).toBe(`${WATER}:natural`);
    expect(withFixed(VARIANTS, AXES, held?.fixed ?? new Map()).map(({ number }) => number)).toEqual([5]);
    expect(writeFixed([])).toBeNull();
  });

  it('have names as short as they can be told apart', () => {
    expect([...shortNames([KP, KD, 'control.heading.kp']).values()]).toEqual(['pid.kp', 'kd', 'heading.kp']);
    expect([...shortNames(['kp']).values()]).toEqual(['kp']);
  });
});

describe('the heat map', () => {
  it('has the greatest value on top, and in each place the best of all that lie there', () => {
    const [kp, kd] = AXES as [(typeof AXES)[number], (typeof AXES)[number]];
    const rows = heatMap(VARIANTS, kp, kd, RMSE);
    expect(rows.map((row) => row.map(({ x, y, variant: best, variants, failed }) => [x, y, best?.number ?? null, variants, failed]))).toEqual([
      [
        [3, 1, 2, 1, 0],
        [10, 1, 4, 1, 3],
      ],
      [
        [3, 0.5, 5, 2, 0],
        [10, 0.5, 3, 1, 0],
      ],
    ]);
  });

  it('takes the nearest to 0 for the best where that is better, and the first where nothing is', () => {
    expect(bestVariant(VARIANTS, ERROR)?.number).toBe(5);
    expect(bestVariant(VARIANTS, { ...PERIOD, name: 'rmse' })?.number).toBe(1);
    expect(bestVariant([], RMSE)).toBeNull();
  });
});

describe('the variant that is shown', () => {
  const shown = (best: number | null, chosen: number | null) => shownVariant({ ...GRID, best: best === null ? null : ({ variant: best } as SweepDetail['best']) }, chosen)?.number ?? null;

  it('is the best as long as nobody has chosen, and then what was chosen', () => {
    expect([shown(2, null), shown(5, null)]).toEqual([2, 5]);
    expect([shown(2, 2), shown(5, 2)]).toEqual([2, 2]);
    expect([shown(5, 99), shown(null, null)]).toEqual([5, null]);
  });
});

describe('shading', () => {
  it('goes from the worst to the best', () => {
    const shading = shadingOf([1, 2, 3], RMSE);
    expect([1, 2, 3].map((value) => shading?.share(value))).toEqual([1, 0.5, 0]);
    const zero = shadingOf([-1, 0, 3], ERROR);
    expect([-1, 0, 3].map((value) => zero?.share(value))).toEqual([expect.closeTo(2 / 3), 1, 0]);
    expect(shadingOf([2, 4], PERIOD)).toMatchObject({ best: 4, worst: 2 });
    expect(shadingOf([], RMSE)).toBeNull();
    expect(shadingOf([2, 2], RMSE)?.share(2)).toBe(1);
  });

  it('is not widened by one that fails altogether', () => {
    const shading = shadingOf([1, 1.1, 1.2, 1.3, 50], RMSE);
    expect(shading).toMatchObject({ best: 1, worst: 1.3, clipped: true });
    expect(shading?.share(50)).toBe(0);
  });
});

describe('words', () => {
  it('say how sure it is that the best is better', () => {
    const own = { low: 0.04, high: 0.06 };
    const next = (difference: number, low: number | null, high: number | null, other = measured(0.09)) => bestWords({ ...own, next: { variant: 7, difference, low, high } }, RMSE, other);
    expect(next(0.04, 0.03, 0.05)).toBe('Better than the next, variant 7, by 0.0400 m; with equal seeds they differ by 0.0300 to 0.0500 m.');
    expect(next(0.001, -0.002, 0.004)).toBe('Not told apart from the next, variant 7: with equal seeds they differ by \u22120.0020 to 0.0040 m, which may be zero.');
    expect(next(0, 0, 0)).toBe('The next, variant 7, is equal to it with every seed.');
    expect(next(0.001, null, null)).toMatch(/^Better than variant 7 by 0.0010 m with one seed\./);
    expect(bestWords({ ...own, next: null }, RMSE)).toBe('It is the only variant.');
    // Seeds that shift both alike leave a small difference sure, which is never written as none.
    const sure = next(0.00002, 0.00001, 0.00003, measured(0.05));
    expect(sure).toBe('Better than the next, variant 7, by 0.00002 m; with equal seeds they differ by 0.00001 to 0.00003 m. This is sure though the intervals of both means overlap: a seed shifts both alike.');
  });

  it('write values and means', () => {
    expect([0.1 + 0.2, -3, 'pool', null].map(valueText)).toEqual(['0.3', '\u22123', 'pool', 'by the seed']);
    expect(valuesWords({ values: [3, 0.5, 'pool'] }, GRID.parameters, shortNames([KP, KD, WATER]))).toBe('kp 3, kd 0.5, kind pool');
    expect(meanWords(measured(0.05), RMSE)).toBe('0.0500 m (0.0400 to 0.0600)');
    expect(meanWords(measured(0.05, null, null), RMSE)).toBe('0.0500 m');
    expect(meanWords(undefined, RMSE)).toBe('–');
    expect(valuesText(parameter(KP, 'list', [1, 2, 3]))).toBe('1, 2, 3');
    expect(valuesText({ ...parameter(KP, 'search', [0.5, 4]), unit: 's' })).toBe('0.5 to 4 s');
    expect(valuesText(parameter(KP, 'range', Array.from({ length: 20 }, (_, at) => at)))).toBe('0 to 19 in 20 steps');
  });
});

describe('the chart', () => {
  const drawing = (entries: Record<string, string>, detail = GRID): Drawing => ({
    plane: planeOf(detail, axesOf(detail), seen(entries)) ?? { figure: RMSE, across: null, up: null, fixed: new Map() },
    variants: detail.variants,
    runs: [],
    across: 'kp',
    up: '',
    best: 5,
    chosen: 2,
    fill: () => '#000000',
    words: () => '',
    token: (name) => name,
  });
  const dotsOf = (one: Drawing) => drawChart(one).data.at(-1) as { x: Value[]; y: number[]; customdata: number[] };

  it('draws a line through the best of each value, with the band of its interval', () => {
    const { data } = drawChart(drawing({ y: FIGURE }));
    expect(data).toHaveLength(5);
    expect(dotsOf(drawing({ y: FIGURE }))).toMatchObject({ x: [3, 10], y: [0.02, 0.04], customdata: [5, 3] });
  });

  it('draws words as categories, without a line', () => {
    const { data, layout } = drawChart(drawing({ x: WATER, y: FIGURE }));
    expect(data).toHaveLength(2);
    expect(layout.xaxis).toMatchObject({ type: 'category', categoryarray: ['pool', 'natural'] });
  });

  it('draws a search with the best so far', () => {
    const search = sweep([variant(1, [0.3], 0.05), variant(2, [0.7], 0.07), variant(3, [0.4], 0.02)], [parameter(KP, 'search')]);
    const { data } = drawChart(drawing({}, search));
    expect(data[0]).toMatchObject({ x: [1, 2, 3], y: [0.05, 0.05, 0.02] });
    expect(dotsOf(drawing({}, search)).customdata).toEqual([1, 2, 3]);
  });

  it('has a dot for each seed', () => {
    const runs = [{ number: 1, variant: 5, seed: 1, figures: { rmse: 0.021 } }] as unknown as Drawing['runs'];
    expect(drawChart({ ...drawing({ y: FIGURE }), runs }).data[3]).toMatchObject({ x: [3], y: [0.021] });
  });
});
