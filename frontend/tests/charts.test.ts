import { describe, expect, it } from 'vitest';
import { depthRange, depthsRange, roundRange, settle } from '../src/charts/range';
import { findSignals, GROUPS, SIGNALS } from '../src/charts/signals';
import { stripsOf } from '../src/charts/strips';
import { ageLabel, agesBefore, momentLabel, momentsBefore, timeStep } from '../src/charts/ticks';
import { ChartTime } from '../src/charts/time.svelte';
import { readAt } from '../src/charts/values';
import { LEAST, SPANS, viewUntil, within, zoomed } from '../src/charts/view';
import { ROW_TOPICS } from '../src/generated/topics';
import { RowRing } from '../src/live/ring';
import { searchChoices } from '../src/parts/choices';
import { join, rowBytes } from './bytes';

describe('signals', () => {
  it('has every number of every topic once, called as in recordings', () => {
    const names = SIGNALS.map(({ name }) => name);
    expect(new Set(names).size).toBe(names.length);
    expect(names).toEqual(expect.arrayContaining(['depth.depth', 'motor.angle_3', 'truth.position_2', 'control.output']));
    const numbers = Object.values(ROW_TOPICS).reduce((sum, { fields }) => sum + fields.reduce((all, { count }) => all + count, 0), 0);
    expect(names).toHaveLength(numbers);
  });

  it('knows what is wanted and what lies downwards', () => {
    const [depth, wanted, fin] = findSignals(['depth.depth', 'control.set_point', 'motor.wanted_1', 'imu.nothing']);
    expect([depth?.wanted, wanted?.wanted, fin?.wanted]).toEqual([false, true, true]);
    expect([depth?.downwards, wanted?.downwards, fin?.downwards]).toEqual([true, true, false]);
    expect(fin?.label).toBe('wanted back right');
  });

  it.each([
    ['depth pressure', ['depth.pressure']],
    ['measured ANGLE front left', ['motor.angle_3']],
    ['no such thing', []],
  ])('finds %s', (search, names) => {
    expect(searchChoices(GROUPS, search).flatMap(({ choices }) => choices.map(({ name }) => name))).toEqual(names);
  });
});

describe('stripsOf', () => {
  it('puts one unit on one axis, and depths on one of their own', () => {
    const strips = stripsOf(findSignals(['depth.depth', 'imu.rate_0', 'control.set_point', 'imu.rate_1', 'control.error', 'motor.drive_0']));
    expect(strips.map(({ traces }) => traces.map(({ signal }) => signal.name))).toEqual([
      ['depth.depth', 'control.set_point'],
      ['imu.rate_0', 'imu.rate_1'],
      ['control.error'],
      ['motor.drive_0'],
    ]);
    expect(strips.map(({ downwards }) => downwards)).toEqual([true, false, false, false]);
  });

  it('tells signals apart by colour', () => {
    const [strip] = stripsOf(findSignals(['motor.angle_0', 'motor.angle_1', 'motor.angle_2', 'motor.angle_3']));
    expect(new Set(strip?.traces.map(({ colour }) => colour)).size).toBe(4);
  });
});

describe('ranges', () => {
  it.each([
    [0.3, 0.5],
    [0.5, 1],
    [1.02, 1.5],
    [9.9, 15],
    [31, 35],
  ])('shows %f m on a chart of %f m', (deepest, range) => {
    expect(depthRange(deepest)).toBe(range);
  });

  it('has the surface in every range of depths', () => {
    expect(depthsRange(0.4, 0.5)[0]).toBeLessThan(0);
  });

  it.each([
    [-1, 1],
    [0.1234, 0.1235],
    [101_300, 101_400],
    [5, 5],
    [0, 0],
    [-3, 700],
  ])('shows all from %f to %f with some room and no more than needed', (least, most) => {
    const [low, high] = roundRange(least, most);
    expect(low).toBeLessThan(least + 1e-12);
    expect(high).toBeGreaterThan(most - 1e-12);
    expect(high).toBeGreaterThan(low);
    if (most > least) expect(high - low).toBeLessThan(3 * (most - least));
  });

  it('stays while the data fill it, grows at once, and shrinks where they do not', () => {
    const first = settle(null, [0, 10], roundRange);
    expect(settle(first, [0.5, 9.5], roundRange)).toBe(first);
    expect(settle(first, null, roundRange)).toBe(first);
    expect(settle(first, [0, 30], roundRange)[1]).toBeGreaterThanOrEqual(30);
    expect(settle(first, [4, 5], roundRange)[1]).toBeLessThan(6);
  });
});

describe('axes of time', () => {
  it.each(SPANS.map(({ seconds }) => seconds))('has readable steps over %i s', (seconds) => {
    for (const pixels of [300, 1300]) {
      const step = timeStep(seconds, pixels, 74);
      const ages = agesBefore(seconds, step);
      expect(ages.at(-1)).toBeCloseTo(0, 9);
      expect(ages[0]).toBeGreaterThanOrEqual(-seconds);
      expect(ages.length).toBeGreaterThan(2);
      expect((seconds / step + 1) * 74).toBeLessThan(pixels + 150);
    }
  });

  it('says ages and moments shortly', () => {
    expect([ageLabel(-30, 10), ageLabel(-120, 60), ageLabel(-0.25, 0.05)]).toEqual(['−30 s', '−2 min', '−0.25 s']);
    const edge = new Date(2026, 6, 1, 14, 3, 5, 250);
    expect(momentsBefore(10, 5, edge.getTime()).map((at) => Number(at.toFixed(3)))).toEqual([-5.25, -0.25]);
    expect(momentLabel(new Date(edge.getTime() - 250), 5)).toBe('14:03:05');
    expect(momentLabel(edge, 0.05)).toBe('14:03:05.25');
  });
});

describe('views', () => {
  it('keeps the moment under the pointer where it is', () => {
    const view = zoomed(viewUntil(100, 60), 0.5, 85);
    expect(view.seconds).toBe(30);
    expect((85 - view.start) / view.seconds).toBeCloseTo((85 - 40) / 60, 9);
  });

  it('stays within what is kept', () => {
    expect(within(viewUntil(2000, 60), 1000).end).toBe(1000);
    expect(within(viewUntil(10, 60), 1000).start).toBe(400);
    expect(within(viewUntil(1000, 5000), 1000)).toEqual(viewUntil(1000, 600));
    expect(within(viewUntil(1000, 0), 1000).seconds).toBe(LEAST);
  });
});

describe('ChartTime', () => {
  it('follows the present until it is held, and each chart keeps its span', () => {
    const time = new ChartTime();
    expect(time.view(60, 1000)).toEqual(viewUntil(1000, 60));
    time.pause(1000);
    time.pause(1001);
    expect(time.view(60, 1010)).toEqual(viewUntil(1000, 60));
    expect(time.view(10, 1010)).toEqual(viewUntil(1000, 10));
    time.resume();
    expect(time.view(60, 1010)).toEqual(viewUntil(1010, 60));
  });

  it('shows one stretch in all charts once it is zoomed, with the cursor on its moment', () => {
    const time = new ChartTime();
    time.ago = 20;
    time.zoom(time.view(60, 1000), 0.5, 980, 1000);
    expect(time.zoomed).toBe(true);
    const view = time.view(10, 1005);
    expect(view.seconds).toBe(30);
    expect(view.end - time.ago).toBeCloseTo(980, 9);
    time.unzoom();
    expect(time.view(10, 1005).seconds).toBe(10);
  });

  it('has its cursor on a moment, also one that is not shown, and says on which', () => {
    const time = new ChartTime();
    expect(time.moment(1000)).toBeNull();
    time.point(990, 1000);
    expect([time.ago, time.moment(1000)]).toEqual([10, 990]);
    time.point(1003, 1000);
    expect([time.ago, time.moment(1000)]).toEqual([-3, 1003]);
    time.pause(1000);
    time.point(980, 1040);
    expect([time.ago, time.moment(1040)]).toEqual([20, 980]);
    time.point(null, 1040);
    expect(time.moment(1040)).toBeNull();
  });

  it('has nothing to hold while no time is known', () => {
    const time = new ChartTime();
    time.pause(NaN);
    time.zoom(viewUntil(NaN, 60), 0.5, NaN, NaN);
    expect(time.held).toBeNull();
  });
});

describe('readAt', () => {
  const ring = new RowRing(ROW_TOPICS.control, 10);
  const samples = [
    [1, 5],
    [2, 6],
    [2.1, 9],
    [2.2, 7],
    [8, NaN],
  ] as const;
  ring.append(new DataView(join(...samples.map(([time, error]) => rowBytes(ROW_TOPICS.control, time, { error: [error] }))).buffer), 0);
  const read = (time: number, width: number) => readAt(ring, ring.column('error'), time, width, 3);

  it.each([
    [2.1, 0.4, { least: 6, most: 9 }],
    [2.1, 0.01, { least: 9, most: 9 }],
    [4, 0.1, { least: 7, most: 7 }],
    [7, 0.1, null],
    [0.5, 0.1, null],
    [8, 0.1, null],
    [8.5, 0.1, null],
  ])('reads at %f s over %f s', (time, width, expected) => {
    expect(read(time, width)).toEqual(expected);
  });

  it('reads angles on both sides of the wrap as the short way between them', () => {
    const angles = new RowRing(ROW_TOPICS.control, 3);
    angles.append(new DataView(join(...[3.125, -3.125].map((error, at) => rowBytes(ROW_TOPICS.control, 1 + at / 10, { error: [error] }))).buffer), 0);
    const { least, most } = readAt(angles, angles.column('error'), 1, 0.5, 3, true) ?? { least: NaN, most: NaN };
    expect([least, most]).toEqual([3.125, expect.closeTo(2 * Math.PI - 3.125, 6)]);
  });
});
