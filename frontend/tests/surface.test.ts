import { describe, expect, it } from 'vitest';
import { findSurfaceDoubt, type Measured } from '../src/live/surface';

const FLOATS: Measured = { depth: 0.01, pressure: 101_423, density: 1000, lost: false };
const at = (depth: number, surface = 101_325): Measured => ({ ...FLOATS, depth, pressure: surface + 9810 * depth });

describe('findSurfaceDoubt', () => {
  it.each([0, 0.6, 10, -0.02, -0.049])('has none at a depth of %s m', (depth) => {
    expect(findSurfaceDoubt(at(depth), null)).toBeNull();
  });

  it('doubts a depth above the surface, until it is at the surface again', () => {
    const doubt = findSurfaceDoubt(at(-0.12), null);
    expect(doubt).toEqual({ kind: 'above', height: 0.12 });
    expect(findSurfaceDoubt(at(-0.04), doubt)?.kind).toBe('above');
    expect(findSurfaceDoubt(at(-0.02), doubt)).toBeNull();
  });

  it('doubts a surface whose pressure is not air’s: the board was switched on in 2 m of water', () => {
    expect(findSurfaceDoubt(at(0, 101_325 + 2 * 9810), null)).toEqual({ kind: 'air', pressure: 120_945 });
    expect(findSurfaceDoubt(at(0.5, 60_000), null)?.kind).toBe('air');
    expect(findSurfaceDoubt(at(0.5, 85_000), null)).toBeNull();
    expect(findSurfaceDoubt({ ...at(20), density: 1025, pressure: 101_325 + 20 * 1025 * 9.81 }, null)).toBeNull();
  });

  it('repeats what the board itself says', () => {
    expect(findSurfaceDoubt({ ...FLOATS, lost: true }, null)).toEqual({ kind: 'lost' });
  });
});
