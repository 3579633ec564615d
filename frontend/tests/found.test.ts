import { describe, expect, it } from 'vitest';
import type { Detection, State } from '../src/generated/topics';
import { foundIn, keepDetections } from '../src/live/found';

const state = { vision_rate: 5 } as State;
const detection = (taken: number) => ({ taken, time: taken + 0.05 }) as Detection;

describe('what was found in a picture of a replay', () => {
  it('is what was searched in that picture, and not the newest', () => {
    // A thumbnail of 10.0 s is shown until that of 12.0 s.
    const detections = keepDetections([], Array.from({ length: 11 }, (_, index) => detection(10 + index / 5)));
    expect(foundIn({ detections, state }, { time: 10 })?.taken).toBe(10);
    expect(foundIn({ detections: detections.slice(2), state }, { time: 10 })).toBeNull();
  });

  it('is kept as long as a thumbnail is shown', () => {
    const kept = keepDetections([detection(1), detection(8.5)], [detection(9), detection(11)]);
    expect(kept.map(({ taken }) => taken)).toEqual([8.5, 9, 11]);
    expect(keepDetections(kept, [])).toEqual(kept);
  });
});
