import { describe, expect, it } from 'vitest';
import { compare, summarise, type Column } from '../src/pages/comm_tests/comparison';
import { drawFigure, type FigureCell } from '../src/pages/comm_tests/figure';
import { facetColumns, gridOf, placesOf } from '../src/pages/comm_tests/grid';
import { differencePaint, ratePaint } from '../src/pages/comm_tests/scale';
import { countCauses, differenceText } from '../src/pages/comm_tests/words';
import { remainingWords, roughly } from '../src/parts/remaining';

const place = (baud: number, arduino_delay: number, pi_delay: number) => ({ baud, arduino_delay, pi_delay });
const column = (id: string, cells: Column['cells']): Column => ({ id, title: id, about: '', cells });

describe('the grid', () => {
  it('numbers the cells as they are run: baud, Arduino delay, Pi delay', () => {
    const places = placesOf({ baud_rate: [9600, 1200], arduinodelay: [1, 0], delay: [0.5, 0] });
    expect(places.slice(0, 3)).toEqual([place(9600, 1, 0.5), place(9600, 1, 0), place(9600, 0, 0.5)]);
    expect(places).toHaveLength(8);
    expect(gridOf(places)).toEqual({ bauds: [1200, 9600], arduinoDelays: [0, 1], piDelays: [0, 0.5] });
  });

  it('is empty where a document lacks a side', () => {
    expect(placesOf({ baud_rate: [9600] })).toEqual([]);
  });

  it('lays facets in even rows', () => {
    expect(facetColumns(5, 1100, 132, 18)).toBe(5);
    expect(facetColumns(5, 320, 132, 18)).toBe(2);
    expect(facetColumns(4, 460, 132, 18)).toBe(2);
    expect(facetColumns(3, 50, 132, 18)).toBe(1);
  });
});

describe('comparing', () => {
  const first = column('a', [
    { ...place(9600, 0, 0), rate: 0.5 },
    { ...place(9600, 0, 1), rate: 1 },
    { ...place(1200, 0, 0), rate: 0.25 },
  ]);
  const second = column('b', [
    { ...place(9600, 0, 0), rate: 0.75 },
    { ...place(9600, 0, 1), rate: 0.998 },
    { ...place(115200, 0, 0), rate: 1 },
  ]);
  const rows = compare([first, second]);

  it('has a row for every place of any column, in order', () => {
    expect(rows.map((row) => row.place)).toEqual([place(1200, 0, 0), place(9600, 0, 0), place(9600, 0, 1), place(115200, 0, 0)]);
    expect(rows.map((row) => row.rates)).toEqual([[0.25, null], [0.5, 0.75], [1, 0.998], [null, 1]]);
  });

  it('measures against the first, and only where both have a cell', () => {
    expect(rows.map((row) => row.differences[1] ?? null)).toEqual([null, 0.25, expect.closeTo(-0.002, 9), null]);
    expect(rows.map((row) => row.differences[0] ?? null)).toEqual([0, 0, 0, null]);
  });

  it('sums up, and takes what prints as equal for equal', () => {
    const summary = summarise(rows, 1);
    expect(summary).toMatchObject({ least: 0.75, common: 2, better: 1, worse: 0 });
    expect(summary.mean).toBeCloseTo((0.75 + 0.998 + 1) / 3, 9);
    expect(summary.difference).toBeCloseTo(0.124, 9);
    expect(summarise(compare([first, column('c', [])]), 1)).toMatchObject({ mean: null, least: null, common: 0, difference: null });
  });
});

describe('the figure', () => {
  const cells: FigureCell[] = [place(9600, 0, 0), place(9600, 0.5, 0), place(1200, 0, 0.5)].map((one) => ({
    place: one,
    text: '0.98',
    paint: ratePaint(0.98),
  }));
  const look = { text: '#000000', muted: '#111111', panel: '#ffffff', line: '#222222', font: 'Inter', cellHigh: 36 };

  it('has a facet for each baud, and in it a bar for each cell', () => {
    const { data, layout } = drawFigure(cells, 700, '9600 0.5 0', look);
    expect(data).toHaveLength(2);
    expect(data[1]).toMatchObject({ x: [0, 0], customdata: ['9600 0 0', '9600 0.5 0'], marker: { line: { width: [0, 3] } } });
    expect(layout).toMatchObject({ annotations: [{ text: '1200 baud' }, { text: '9600 baud' }] });
  });

  it('grows downwards where the screen is narrow', () => {
    expect(drawFigure(cells, 100, '', look).height).toBeGreaterThan(drawFigure(cells, 700, '', look).height);
  });
});

describe('colours', () => {
  it('begin and end where the scale does', () => {
    expect(ratePaint(0).fill).toBe('rgb(68 1 84)');
    expect(ratePaint(1).fill).toBe('rgb(253 231 37)');
    expect(ratePaint(1.5).fill).toBe(ratePaint(1).fill);
    expect(differencePaint(0, '#ff0000', '#808080', '#0000ff').fill).toBe('rgb(128 128 128)');
    expect(differencePaint(-1, '#ff0000', '#808080', '#0000ff').fill).toBe('rgb(255 0 0)');
  });

  it('let every number be read', () => {
    for (let rate = 0; rate <= 1; rate += 0.01) expect(contrast(ratePaint(rate))).toBeGreaterThanOrEqual(4.5);
  });

  function contrast({ fill, ink }: { fill: string; ink: string }): number {
    const linear = (value: number) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4);
    const [red = 0, green = 0, blue = 0] = fill.match(/\d+/g)?.map(Number) ?? [];
    const light = 0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue);
    return ink === '#ffffff' ? 1.05 / (light + 0.05) : (light + 0.05) / 0.05;
  }
});

describe('words', () => {
  it('round a time to what matters', () => {
    expect([3, 41, 58, 200, 3600, 4140].map(roughly)).toEqual([
      'about 5 s',
      'about 45 s',
      'about 1 min',
      'about 3 min',
      'about 1 h',
      'about 1 h 9 min',
    ]);
  });

  it('count the remaining time down between two messages', () => {
    expect(remainingWords(null, 3)).toBe('not known yet');
    expect(remainingWords(40, 0)).toBe('about 40 s');
    expect(remainingWords(40, 20)).toBe('about 20 s');
    expect(remainingWords(40, 45)).toBe('a moment');
  });

  it('give differences their sign', () => {
    expect([0.25, -0.25, 0.001, -0.001, null].map(differenceText)).toEqual(['+0.25', '\u22120.25', '±0.00', '±0.00', '–']);
  });

  it('count causes', () => {
    const cells = [{ causes: ['ring overrun', 'checksum'] }, { causes: ['checksum'] }, { causes: [] }];
    expect(countCauses(cells)).toEqual([['checksum', 2], ['ring overrun', 1]]);
  });
});
