import { describe, expect, it } from 'vitest';
import type { Flag, Segment, SignalLine } from '../src/api';
import { across, depthSteps, gatherFlags, lowestOf, piecesOf, stairs, swimmersOf, timeAt, timeSteps, valueAt, type Scale } from '../src/story/profile';

const KINDS = { disarmed: 'Disarmed', manual: 'By hand', unknown: 'Armed' };
const scale: Scale = { view: { start: 0, end: 100 }, width: 1000, height: 200, lowest: 2 };
const line = (points: readonly (readonly [number, number | null, number | null])[]): SignalLine => ({
  time: points.map(([time]) => time),
  low: points.map(([, low]) => low),
  high: points.map(([, , high]) => high),
});
const segment = (start: number, end: number, more: Partial<Segment> = {}): Segment => ({
  start,
  end,
  mode: 'automatic',
  controller: 'pid',
  title: 'PID',
  gains: {},
  holds_depth: true,
  set_point: 1,
  ...more,
});
const flag = (time: number, severity: Flag['severity'] = 'info'): Flag => ({ time, kind: 'event', severity, text: `at ${time}` });

describe('the depth profile', () => {
  it('is coloured by who swam, and each piece begins where the one before ends', () => {
    const dive = line([
      [0, 0, 0],
      [10, 0.5, 0.5],
      [20, 1, 1],
      [30, 1, 1],
    ]);
    const pieces = piecesOf(dive, [segment(10, 20), segment(20, 30, { mode: 'manual', controller: '', title: '' })], scale, KINDS);
    expect(pieces.map(({ swimmer }) => swimmer.title)).toEqual(['Disarmed', 'PID', 'By hand', 'Disarmed']);
    expect(pieces.map(({ path }) => path)).toEqual(['M0.0 0.0', 'M0.0 0.0L100.0 50.0', 'M100.0 50.0L200.0 100.0', 'M200.0 100.0L300.0 100.0']);
    expect(swimmersOf(pieces)).toHaveLength(3);
  });

  it('breaks where nothing was recorded, and loses no peak of a column', () => {
    const [first, second] = piecesOf(
      line([
        [0, 0.5, 1.5],
        [10, null, null],
        [20, 1, 1],
      ]),
      [segment(0, 100)],
      scale,
      KINDS,
    );
    expect(first?.path).toBe('M0.0 50.0L0.0 150.0');
    expect(second?.path).toBe('M200.0 100.0');
  });

  it('draws the set point as stairs', () => {
    const steps = line([
      [0, 0.5, 0.5],
      [10, 1, 1],
      [20, null, null],
      [30, 1, 1],
    ]);
    expect(stairs(steps, scale)).toBe('M0.0 50.0H100.0V100.0M300.0 100.0');
  });

  it('reaches a little below the deepest point, and shows a shallow dive, too', () => {
    expect(lowestOf([line([[0, 0, 2]]), null])).toBeCloseTo(2.2);
    expect(lowestOf([line([])])).toBeCloseTo(0.33);
  });

  it('has whole steps that do not touch', () => {
    expect(depthSteps(scale)).toEqual([0, 0.5, 1, 1.5, 2]);
    expect(timeSteps(scale)).toEqual([0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100]);
    expect(timeSteps({ ...scale, view: { start: 0, end: 8 * 3600 } })).toHaveLength(9);
  });

  it('finds the time at a place, and the place of a time', () => {
    expect(timeAt(scale, across(scale, 42))).toBeCloseTo(42);
    expect(timeAt(scale, -5)).toBe(0);
    expect(timeAt(scale, 2000)).toBe(100);
  });

  it('reads the value of the newest column', () => {
    const dive = line([
      [0, 0, 0],
      [10, 0.4, 0.6],
    ]);
    expect(valueAt(dive, 9)).toBe(0);
    expect(valueAt(dive, 15)).toBeCloseTo(0.5);
    expect(valueAt(line([]), 1)).toBeNull();
  });
});

describe('flags', () => {
  it('are gathered where they would lie over each other, named by the gravest', () => {
    const [dense, single] = gatherFlags([flag(10), flag(11, 'alarm'), flag(12), flag(50)], scale);
    expect(dense?.flags).toHaveLength(3);
    expect(dense?.gravest.time).toBe(11);
    expect(dense?.room).toBe(400);
    expect(single?.room).toBe(500);
  });

  it('outside of the view are not shown', () => {
    expect(gatherFlags([flag(10), flag(50)], { ...scale, view: { start: 40, end: 60 } })).toHaveLength(1);
  });
});
