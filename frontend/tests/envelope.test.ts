import { describe, expect, it } from 'vitest';
import { envelope, spanOf, times, type Point, type TimedColumns } from '../src/charts/envelope';
import { depthRange } from '../src/charts/range';

function series(samples: readonly (readonly [number, number])[]): { ring: TimedColumns; values: Float64Array } {
  const time = Float64Array.from(samples, ([at]) => at);
  const ring = {
    length: samples.length,
    time,
    place: (order: number) => order,
    firstSince: (since: number) => samples.filter(([at]) => at < since).length,
  };
  return { ring, values: Float64Array.from(samples, ([, value]) => value) };
}

const numbers = (points: readonly Point[]) => points.filter((point) => typeof point === 'number');

describe('envelope', () => {
  it('loses no spike of one sample in a minute at 100 Hz', () => {
    const samples = Array.from({ length: 6000 }, (_, index) => [1000 + index / 100, index === 4321 ? 9 : 1] as const);
    const { ring, values } = series(samples);
    for (const columns of [60, 333, 800]) {
      const points = envelope(ring, values, spanOf(1060, 60, columns), 1);
      expect(numbers(points)).toContain(9);
      expect(points.length).toBeLessThanOrEqual(2 * (columns + 2));
    }
  });

  it('gives least and greatest in the order in which they came', () => {
    const { ring, values } = series([
      [0.1, 5],
      [0.2, 7],
      [0.3, 2],
      [1.1, 1],
      [1.2, 3],
    ]);
    const points = envelope(ring, values, { first: 0, columns: 2, width: 1 }, 10);
    expect(points).toEqual([7, 2, 1, 3]);
  });

  it('keeps what a column holds while time goes on', () => {
    const samples = Array.from({ length: 500 }, (_, index) => [index / 50, Math.sin(index)] as const);
    const { ring, values } = series(samples);
    const before = spanOf(10, 10, 40);
    const after = spanOf(10.6, 10, 40);
    const shift = 2 * (after.first - before.first);
    const early = envelope(ring, values, before, 1).slice(shift, 70);
    expect(shift).toBeGreaterThan(0);
    expect(envelope(ring, values, after, 1).slice(0, 70 - shift)).toEqual(early);
  });

  it('lets the line run on over empty columns, and breaks it where samples are missing', () => {
    const { ring, values } = series([
      [0.5, 1],
      [3.5, 2],
      [8.5, 3],
    ]);
    const points = envelope(ring, values, { first: 0, columns: 9, width: 1 }, 4);
    expect(points.slice(2, 6).every((point) => point === undefined)).toBe(true);
    expect(points.slice(8, 16).every((point) => point === null)).toBe(true);
  });

  it('has a place in time for every point', () => {
    const span = spanOf(100, 10, 5);
    const all = times(span, 100);
    expect(all).toHaveLength(2 * span.columns);
    expect(all[0]).toBeCloseTo(-9.5, 9);
    expect((all[1] ?? NaN) - (all[0] ?? NaN)).toBeCloseTo(1, 9);
  });
});

describe('depthRange', () => {
  it.each([
    [0.3, 0.5],
    [0.5, 1],
    [1.02, 1.5],
    [9.9, 15],
    [31, 35],
  ])('shows %f m on a chart of %f m', (deepest, range) => {
    expect(depthRange(deepest)).toBe(range);
  });
});
