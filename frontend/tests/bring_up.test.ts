import { afterEach, beforeEach, describe, expect, it, test, vi } from 'vitest';
import type { RawReadings, BringUpStep } from '../src/api';
import { Hold } from '../src/pages/bring_up/hold';
import { kindOf, openStep, readings } from '../src/pages/bring_up/steps';

const EVERY = 100;

describe('Hold', () => {
  beforeEach(() => void vi.useFakeTimers());
  afterEach(() => void vi.useRealTimers());

  /** A button whose posts take this long (ms) and are accepted until the one of this number. */
  function button(takes: number, refused = Infinity) {
    const posts: { at: number; inputs: object }[] = [];
    const ended = vi.fn();
    const began = Date.now();
    const hold = new Hold(async (inputs) => {
      posts.push({ at: Date.now() - began, inputs });
      await new Promise((resolve) => setTimeout(resolve, takes));
      return posts.length < refused;
    }, EVERY, ended);
    return { hold, posts, ended };
  }

  it('repeats its action while held, and ends it once', async () => {
    const { hold, posts } = button(10);
    hold.begin();
    await vi.advanceTimersByTimeAsync(250);
    hold.release();
    await vi.advanceTimersByTimeAsync(1000);
    expect(posts).toEqual([
      { at: 0, inputs: {} },
      { at: 100, inputs: { on: 1 } },
      { at: 200, inputs: { on: 1 } },
      { at: 300, inputs: { stop: 1 } },
    ]);
  });

  it('ends a slow action only after its answer, so that nothing comes after the end', async () => {
    const { hold, posts } = button(400);
    hold.begin();
    await vi.advanceTimersByTimeAsync(50);
    hold.release();
    await vi.advanceTimersByTimeAsync(2000);
    expect(posts).toEqual([{ at: 0, inputs: {} }, { at: 400, inputs: { stop: 1 } }]);
  });

  it('does not repeat what was refused, and says that it has ended', async () => {
    const { hold, posts, ended } = button(10, 2);
    hold.begin();
    await vi.advanceTimersByTimeAsync(1000);
    expect(posts.map(({ inputs }) => inputs)).toEqual([{}, { on: 1 }, { stop: 1 }]);
    expect(ended).toHaveBeenCalledTimes(1);
  });

  it('begins anew where it is pressed again before it has ended', async () => {
    const { hold, posts } = button(50);
    hold.begin();
    hold.release();
    await vi.advanceTimersByTimeAsync(60);
    hold.begin();
    await vi.advanceTimersByTimeAsync(60);
    hold.release();
    await vi.advanceTimersByTimeAsync(1000);
    expect(posts.map(({ inputs }) => inputs)).toEqual([{}, { stop: 1 }, {}, { stop: 1 }]);
  });
});

const step = (name: string, state: BringUpStep['state']) => ({ name, state }) as BringUpStep;

test('a step opens by its name, or else the first that is not done', () => {
  const steps = [step('devices', 'done'), step('battery', 'wrong'), step('fin_2', 'open')];
  expect(openStep(steps, 'fin_2')).toBe(2);
  expect(openStep(steps, undefined)).toBe(1);
  expect(openStep(steps, 'nonsense')).toBe(1);
  expect(openStep(steps.slice(0, 1), undefined)).toBe(0);
  expect(kindOf('fin_2')).toEqual({ kind: 'fin', fin: 2 });
  expect(kindOf('toString').kind).toBe('other');
});

const RAW: RawReadings = {
  encoders: [
    { counts: 0, field: 'green' },
    { counts: 256, field: 'yellow' },
    { counts: 0, field: 'silent' },
    { counts: 1023, field: 'red' },
  ],
  imu: { identity: 0x68, force: [0.01, -0.02, 1], rate: [0, -1.25, 3] },
  pressure_hpa: 1013.25,
  temperature: null,
  battery_volts: 7.456,
  beacons: { right: true, left: false },
  leak: true,
};

test.each([
  ['fin_1', RAW, ['256 (90°)']],
  ['motor_0', RAW, ['0 (0°)', '256 (90°)', 'silent', '1023 (360°)']],
  ['sensors', RAW, ['green', 'yellow', 'silent', 'red', '0x68']],
  ['battery', RAW, ['7.46']],
  ['axes', RAW, ['0.01, −0.02, 1.00']],
  ['gyro', { ...RAW, imu: null }, ['–']],
  ['pressure', RAW, ['1013.3', '–']],
  ['beacons', RAW, ['high', 'low']],
  ['leak', RAW, ['wet']],
  ['leak', { ...RAW, leak: false }, ['dry']],
  ['devices', RAW, []],
])('the readings of %s are those of its parts', (name, raw, values) => {
  expect(readings(name, raw).map(({ value }) => value)).toEqual(values);
});
