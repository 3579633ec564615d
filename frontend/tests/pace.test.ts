import { describe, expect, it } from 'vitest';
import { Pace } from '../src/live/pace';

const FRAME = 1 / 60;

/** When a chart is drawn in 10 s, at frames of a screen; `arrivals` s apart samples come, first at `first`. */
function drawings(step: number, arrivals = Infinity, first = 0): number[] {
  const pace = new Pace();
  const drawn: number[] = [];
  let next = first;
  let fresh = false;
  for (let frame = 0; frame < 600; frame += 1) {
    const now = 1000 + frame * FRAME;
    while (next <= frame * FRAME) {
      fresh = true;
      next += arrivals;
    }
    if (!pace.isDue(now, step, fresh)) continue;
    drawn.push(frame * FRAME);
    fresh = false;
  }
  return drawn;
}

describe('the pace of a chart', () => {
  it('is one drawing a step, although frames do not fall on steps', () => {
    for (const step of [1 / 8, 1 / 32, 1 / 45]) expect(drawings(step).length * step).toBeCloseTo(10, 0);
  });

  it('is every frame where a step is shorter than one', () => {
    expect(drawings(1 / 90)).toHaveLength(600);
  });

  it('draws samples that come once a step in the frame in which they are there', () => {
    const step = 1 / 32;
    for (let first = 0; first < step; first += step / 10) {
      const drawn = drawings(step, step, first);
      const waits = Array.from({ length: 300 }, (_, number) => {
        const came = first + number * step;
        return (drawn.find((at) => at >= came) ?? Infinity) - came;
      });
      expect(waits.slice(2).filter((wait) => wait > 1.01 * FRAME)).toEqual([]);
      expect(drawn.length).toBeLessThan(1.1 * (10 / step));
    }
  });

  it('is at most two drawings a step, however often samples come', () => {
    expect(drawings(1 / 10, FRAME).length).toBeLessThanOrEqual(200);
  });

  it('draws at once where time has gone back', () => {
    const pace = new Pace();
    expect(pace.isDue(1000, 0.03, true)).toBe(true);
    expect(pace.isDue(1000.01, 0.03, false)).toBe(false);
    expect(pace.isDue(5, 0.03, false)).toBe(true);
    expect(pace.isDue(5.01, 0.03, false)).toBe(false);
    expect(pace.isDue(5.04, 0.03, false)).toBe(true);
  });
});
