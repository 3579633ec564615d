import { describe, expect, it } from 'vitest';
import { Edits } from '../src/parts/edits.svelte';

describe('values of the robot that are changed', () => {
  const robot = { told: { default: 1.25, detected: 1 } as Record<string, number>, time: 10 };
  /** The robot's next state. Deriveds that nobody watches are computed at each reading. */
  const tell = (told: Record<string, number>, time: number) => Object.assign(robot, { told, time });
  const begin = () => {
    tell({ default: 1.25, detected: 1 }, 10);
    return new Edits<number>(
      () => robot.told,
      () => robot.time,
    );
  };

  it('are wanted and changed as long as they differ from what is in force', () => {
    const edits = begin();
    edits.write('default', 0.6);
    expect(edits.wanted).toEqual({ default: 0.6, detected: 1 });
    expect([edits.changed('default'), edits.changed('detected')]).toEqual([true, false]);
    edits.write('default', 1.25);
    expect(edits.changed('default')).toBe(false);
    edits.write('default', NaN);
    expect(edits.changed('default')).toBe(true);
    edits.forget('default');
    expect(edits.wanted.default).toBe(1.25);
  });

  it('that were sent are forgotten, and those that were written meanwhile stay', () => {
    const edits = begin();
    edits.write('default', 0.6);
    edits.write('detected', 2);
    edits.taken({ default: 0.6 });
    expect(edits.edited).toEqual({ detected: 2 });
    // A field that was emptied to type another number.
    edits.write('detected', NaN);
    edits.taken({ detected: 2 });
    expect(edits.edited).toEqual({ detected: NaN });
  });

  it('do not go back to the old value before the robot tells of what it has taken', () => {
    const edits = begin();
    edits.write('default', 0.7);
    edits.taken({ default: 0.7 });
    expect(edits.wanted.default).toBe(0.7);
    expect(edits.changed('default')).toBe(false);
    tell({ default: 1.25, detected: 1 }, 10.5);
    expect(edits.wanted.default).toBe(0.7);
    tell({ default: 0.7, detected: 1 }, 11);
    expect(edits.wanted.default).toBe(0.7);
    tell({ default: 2, detected: 1 }, 11.5);
    expect(edits.wanted.default).toBe(2);
  });

  it('that the robot did not keep are shown as it tells of them', () => {
    const edits = begin();
    edits.taken({ default: 0.7 });
    tell({ default: 1.25, detected: 1 }, 11.5);
    expect(edits.wanted.default).toBe(1.25);
  });
});
