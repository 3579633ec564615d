import { describe, expect, it } from 'vitest';
import { degrees, euler } from '../src/attitude';

const half = (angle: number) => [Math.cos((angle * Math.PI) / 360), Math.sin((angle * Math.PI) / 360)] as const;

describe('euler', () => {
  it.each([
    ['roll', 1, 30],
    ['roll', 1, -170],
    ['pitch', 2, 80],
    ['pitch', 2, -20],
    ['yaw', 3, 120],
    ['yaw', 3, -90],
  ] as const)('finds a turn in %s alone', (name, axis, angle) => {
    const quaternion = [half(angle)[0], 0, 0, 0];
    quaternion[axis] = half(angle)[1];
    const found = euler(quaternion);
    expect(degrees(found[name])).toBeCloseTo(angle, 6);
    for (const other of ['roll', 'pitch', 'yaw'] as const) {
      if (other !== name) expect(found[other]).toBeCloseTo(0, 6);
    }
  });

  it('survives a quaternion that rounding made too long', () => {
    const [c, s] = half(90);
    expect(euler([c * 1.0001, 0, s * 1.0001, 0]).pitch).toBeCloseTo(Math.PI / 2, 6);
  });
});
