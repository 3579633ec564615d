import { describe, expect, it } from 'vitest';
import { PLACES, placeOf, valueAt } from '../src/pages/tune/bench/scale';

describe('a slider of gains', () => {
  it('reaches both ends of its range', () => {
    for (const [least, most] of [
      [0, 50],
      [0.0005, 0.05],
      [-0.5, 0.5],
    ] as const) {
      expect(valueAt(0, least, most)).toBe(least);
      expect(valueAt(PLACES, least, most)).toBe(most);
    }
  });

  it('has most of its places where gains are small', () => {
    expect(valueAt(PLACES / 2, 0, 50)).toBe(12.5);
    expect(valueAt(1, 0, 50)).toBeLessThan(0.001);
    expect(valueAt(PLACES / 2, -0.5, 0.5)).toBe(0);
  });

  it('stands where its value is', () => {
    for (const value of [0, 0.4, 3, 7.25, 50]) expect(valueAt(placeOf(value, 0, 50), 0, 50)).toBeCloseTo(value, 1);
    expect(placeOf(80, 0, 50)).toBe(PLACES);
  });
});
