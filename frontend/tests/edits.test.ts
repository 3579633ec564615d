import { describe, expect, it } from 'vitest';
import { writtenSince } from '../src/parts/edits';

describe('entries that were sent', () => {
  it('are forgotten, and those that were written meanwhile stay', () => {
    expect(writtenSince({ default: 0.6, detected: 1 }, { default: 0.6, detected: 1 })).toEqual({});
    expect(writtenSince({ default: 1.2, detected: 1 }, { default: 0.6 })).toEqual({ default: 1.2, detected: 1 });
    // A field that was emptied to type another number.
    expect(writtenSince({ default: NaN }, { default: 0.6 })).toEqual({ default: NaN });
  });
});
