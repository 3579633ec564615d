import { expect, test } from 'vitest';
import { curve } from '../src/pages/robots/curve';

const points = (path: string) => path.slice(1).split(/[ML]/).map((point) => point.split(' ').map(Number));

test('the newest depth is at the right edge, and the deepest at the bottom', () => {
  const path = points(curve([0, 1, 2], 118, 36));
  expect(path).toEqual([
    [114, 2],
    [116, 18],
    [118, 34],
  ]);
});

test('a robot at rest is a line at the surface, whatever its noise', () => {
  for (const [, y] of points(curve([0.01, -0.02, 0], 118, 36))) expect(y).toBeLessThan(3);
});

test('a curve breaks where the depth is not known', () => {
  expect(curve([1, null, 1, 1], 118, 36).match(/M/g)).toHaveLength(2);
  expect(curve([null, null], 118, 36)).toBe('');
  expect(curve([], 118, 36)).toBe('');
});
