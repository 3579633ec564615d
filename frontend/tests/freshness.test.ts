import { describe, expect, it } from 'vitest';
import { freshness, staleAfter, worst } from '../src/live/freshness';

describe('freshness', () => {
  it('is stale after a second, or after three missed periods where those are longer', () => {
    expect(staleAfter(0.01)).toBe(1);
    expect(staleAfter(1)).toBe(3);
    expect(freshness(10, 10.99, 0.01).state).toBe('fresh');
    expect(freshness(10, 11.01, 0.01).state).toBe('stale');
    expect(freshness(10, 12.99, 1).state).toBe('fresh');
    expect(freshness(10, 13.01, 1).state).toBe('stale');
  });

  it('says how old', () => {
    expect(freshness(10, 17.5, 1).age).toBeCloseTo(7.5, 9);
  });

  it('takes a sample from a moment ahead for a new one', () => {
    expect(freshness(10.002, 10, 0.01)).toEqual({ state: 'fresh', age: 0 });
  });

  it('knows nothing without a sample or without a clock', () => {
    expect(freshness(null, 10, 1).state).toBe('none');
    expect(freshness(10, NaN, 1).state).toBe('none');
  });

  it('goes by the worst of several', () => {
    const fresh = freshness(10, 10.1, 1);
    const stale = freshness(1, 10.1, 1);
    const staler = freshness(0, 10.1, 1);
    expect(worst([fresh, staler, stale])).toBe(staler);
    expect(worst([freshness(null, 1, 1), fresh])).toBe(fresh);
  });
});
