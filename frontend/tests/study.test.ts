import { describe, expect, it } from 'vitest';
import { readLimits, writeLimits } from '../src/pages/sessions/study/figure';

describe('the ends of an axis in the address', () => {
  it('are read as they were written', () => {
    for (const limits of [
      { least: 0, most: 1.5 },
      { least: -2, most: null },
      { least: null, most: 1e-6 },
    ]) {
      expect(readLimits(writeLimits(limits) ?? '')).toEqual(limits);
    }
    expect(writeLimits({ least: null, most: null })).toBeNull();
  });

  it('are automatic where they are nonsense', () => {
    for (const nonsense of ['', ',', 'x,1', '1', '1,2,3', '1e999,2', 'NaN,1']) expect(readLimits(nonsense)).toEqual({ least: null, most: null });
  });
});
