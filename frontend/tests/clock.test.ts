import { describe, expect, it } from 'vitest';
import { calendar, SteadyClock } from '../src/live/clock';

describe('SteadyClock', () => {
  it('goes by what took the least time to arrive', () => {
    let local = 50;
    const clock = new SteadyClock(() => local);
    expect(clock.now()).toBeNaN();
    for (const late of [0.2, 0.005, 0.4]) {
      local += 1;
      clock.observe(local + 1000 - late);
    }
    expect(clock.now()).toBeCloseTo(local + 1000 - 0.005, 9);
  });

  it('is not put back by old samples of a replay', () => {
    const clock = new SteadyClock(() => 50);
    clock.observe(1050);
    clock.observe(750);
    expect(clock.now()).toBe(1050);
  });

  it('follows a clock that drifts', () => {
    let local = 0;
    const clock = new SteadyClock(() => local, 30);
    for (; local < 600; local += 1) clock.observe(local * 0.999);
    expect(clock.now()).toBeLessThan(600 * 0.999 + 0.1);
    expect(clock.now()).toBeGreaterThan(600 * 0.999 - 0.1);
  });

  it('starts anew after a reset', () => {
    const clock = new SteadyClock(() => 50);
    clock.observe(5000);
    clock.reset();
    clock.observe(60);
    expect(clock.now()).toBe(60);
  });
});

it('tells the calendar from the steady clock', () => {
  expect(calendar(12, { steady: 10, utc: 1_700_000_000 }).getTime()).toBe(1_700_000_002_000);
  expect(calendar(12, null).getTime()).toBeNaN();
});
