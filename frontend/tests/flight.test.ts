import { describe, expect, it } from 'vitest';
import { compassMarks, compassName, fit, onTape, tapeMarks, turnTo } from '../src/flight/geometry';
import { sampleAt } from '../src/flight/readings';
import { ROW_TOPICS } from '../src/generated/topics';
import { RowRing } from '../src/live/ring';
import { rowBytes } from './bytes';

describe('the picture', () => {
  it('keeps its shape in a room of any other', () => {
    expect(fit(1440, 900, { width: 640, height: 480 })).toEqual({ x: 120, y: 0, width: 1200, height: 900 });
    expect(fit(390, 500, { width: 640, height: 480 })).toEqual({ x: 0, y: 103.75, width: 390, height: 292.5 });
  });
});

describe('a tape', () => {
  it('has its marks at whole steps, named each fifth, and begins at the surface', () => {
    const marks = tapeMarks(0.24, 100, 200, 0.1, 5, 0);
    expect(marks.map(({ value }) => value.toFixed(1))).toEqual(['0.0', '0.1', '0.2', '0.3', '0.4', '0.5', '0.6', '0.7']);
    expect(marks.filter(({ named }) => named).map(({ value }) => value.toFixed(1))).toEqual(['0.0', '0.5']);
    expect(marks[0]?.at).toBeCloseTo(-48);
    expect(marks[5]?.at).toBeCloseTo(52);
  });

  it('has no mark beyond its ends', () => {
    for (const value of [0, 0.05, 0.1, 3.333]) {
      for (const { at } of tapeMarks(value, 80, 190, 0.1, 5)) expect(Math.abs(at)).toBeLessThanOrEqual(80 + 1e-6);
    }
  });

  it('goes on over north', () => {
    const marks = compassMarks(355, 70, 7);
    expect(marks.map(({ value }) => value)).toEqual([350, 0]);
    expect(marks.map(({ at }) => at)).toEqual([-35, 35]);
    expect(compassMarks(5, 70, 7).map(({ value }) => value)).toEqual([0, 10]);
    expect([0, 30, 90, 120, 180, 270, 330].map(compassName)).toEqual(['N', '03', 'E', '12', 'S', 'W', '33']);
  });

  it('turns the short way round', () => {
    expect(turnTo(350, 10)).toBe(20);
    expect(turnTo(10, 350)).toBe(-20);
    expect(turnTo(90, 90)).toBe(0);
  });

  it('says where a set point lies beyond its end', () => {
    expect(onTape(40, 100)).toEqual({ at: 40, beyond: false });
    expect(onTape(-140, 100)).toEqual({ at: -100, beyond: true });
  });
});

describe('samples', () => {
  it('are each shown at their own time, none made up between two', () => {
    const ring = new RowRing(ROW_TOPICS.depth, 8);
    expect(sampleAt(ring, 1)).toBeNull();
    for (const time of [1, 1.02, 1.04]) ring.append(new DataView(rowBytes(ROW_TOPICS.depth, time).buffer), -Infinity);
    const shown = [0.5, 1, 1.01, 1.02, 1.03, 9, NaN].map((time) => sampleAt(ring, time)?.time);
    expect(shown).toEqual([1, 1, 1, 1.02, 1.02, 1.04, 1.04]);
  });
});
