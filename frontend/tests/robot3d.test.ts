import { describe, expect, it } from 'vitest';
import { finAt, HEAD_FACETS, HULL, MOUNTS } from '../src/panels/robot/shape';
import { dot, eyeOf, turn, turnBack, type Quaternion, type Vector } from '../src/panels/robot/space';

const half = Math.SQRT1_2;
const near = (a: Vector, b: Vector) => a.forEach((one, at) => expect(one).toBeCloseTo(b[at] ?? NaN, 9));

describe('the robot in space', () => {
  it('turns as its attitude says: nose to the right, nose up, right side down', () => {
    const yaw: Quaternion = [half, 0, 0, half];
    const pitch: Quaternion = [half, 0, half, 0];
    const roll: Quaternion = [half, half, 0, 0];
    near(turn(yaw, [1, 0, 0]), [0, 1, 0]);
    near(turn(pitch, [1, 0, 0]), [0, 0, -1]);
    near(turn(roll, [0, 1, 0]), [0, 0, 1]);
    near(turnBack(roll, turn(roll, [0.1, 0.2, 0.3])), [0.1, 0.2, 0.3]);
  });

  it('is seen the right way round', () => {
    const { see } = eyeOf({ azimuth: Math.PI, elevation: 0, distance: 1 });
    expect(see([0, 0.1, 0])[0]).toBeGreaterThan(0);
    expect(see([0, 0, 0.1])[1]).toBeGreaterThan(0);
    expect(Math.hypot(...see([0, 0, 0]))).toBeCloseTo(0, 9);
    const [, above] = eyeOf({ azimuth: Math.PI, elevation: 1.4, distance: 1 }).see([0.1, 0, 0]);
    expect(above).toBeLessThan(0);
  });

  it('has a closed hull that looks outwards', () => {
    for (const { corners, normal } of [...HULL]) expect(dot(normal, corners[0] ?? [0, 0, 0])).toBeGreaterThan(0);
    for (const { corners, normal } of HEAD_FACETS) expect(dot(normal, [1, 0, 0]) * ((corners[0]?.[0] ?? 0) - 0.122)).toBeGreaterThan(-0.02);
    const reach = (axis: 0 | 1 | 2) => Math.max(...HULL.flatMap(({ corners }) => corners.map((corner) => corner[axis])));
    expect([reach(0), reach(1), reach(2)]).toEqual([0.12, 0.05, 0.05].map((most): unknown => expect.closeTo(most, 9)));
  });

  it('has fins that point outwards along their mounts, and down as their angles grow', () => {
    const tip = (index: number, angle: number) => finAt(index, angle).corners[6] ?? [NaN, NaN, NaN];
    MOUNTS.forEach(({ pivot, right }, index) => {
      const [forward, outwards, down] = tip(index, 0);
      expect(outwards * right).toBeCloseTo(0.065 + 0.088 / 2, 9);
      // Front fins lie aft, back fins forward.
      expect(Math.sign(forward - pivot[0])).toBe(-Math.sign(pivot[0]));
      expect(down).toBeCloseTo(0, 9);
      near(tip(index, Math.PI / 2), [pivot[0], pivot[1], 0.088]);
      near(tip(index, -Math.PI / 2), [pivot[0], pivot[1], -0.088]);
    });
  });
});
