import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { approach, combine, NEUTRAL, X, YAW, Z, type Axes } from '../src/drive/axes';
import { Pilot, type Said } from '../src/drive/pilot.svelte';

let said: Said[];
let lease: number | null;
let now: number;
let page: EventTarget;
let pilot: Pilot;
let end: () => void;
let kept: Set<number>;

beforeEach(() => {
  vi.useFakeTimers();
  said = [];
  lease = 5;
  now = 100;
  kept = new Set();
  page = new EventTarget();
  vi.stubGlobal('window', new EventTarget());
  vi.stubGlobal('document', page);
  pilot = new Pilot({ say: (one) => said.push(one), now: () => now, lease: () => lease, keeps: (axis) => kept.has(axis) });
  pilot.handling.setSpeed(9);
  end = pilot.start();
});

afterEach(() => {
  end();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const forwards = [{ axis: X, amount: 1 }] as const;
const last = () => said.at(-1)?.axes;

describe('Pilot', () => {
  it('says neutral ten times a second while nothing is held', () => {
    vi.advanceTimersByTime(2000);
    expect(said).toHaveLength(20);
    expect(last()).toEqual(NEUTRAL);
  });

  it('says at once that something is held or let go, and twenty times a second what is held', () => {
    pilot.hold('w', forwards);
    expect(last()?.[X]).toBeGreaterThan(0);
    vi.advanceTimersByTime(1000);
    expect(said).toHaveLength(21);
    expect(last()?.[X]).toBe(1);
    pilot.hold('w', []);
    expect(said).toHaveLength(22);
    expect(last()).toEqual(NEUTRAL);
  });

  it('goes as far as the speed step lets it, and adds the trim while something is held', () => {
    pilot.handling.setSpeed(3);
    pilot.handling.setTrim(YAW, 0.05);
    vi.advanceTimersByTime(200);
    expect(last()).toEqual(NEUTRAL);
    pilot.hold('w', forwards);
    vi.advanceTimersByTime(1000);
    expect(last()?.[X]).toBeCloseTo(1 / 3, 9);
    expect(last()?.[YAW]).toBeCloseTo(0.06, 9);
    kept.add(YAW);
    vi.advanceTimersByTime(50);
    expect(last()?.[YAW]).toBe(0);
    pilot.hold('d', [{ axis: YAW, amount: 1 }]);
    vi.advanceTimersByTime(1000);
    expect(last()?.[YAW]).toBeCloseTo(1 / 3 + 0.06, 9);
    pilot.handling.resetTrim();
    pilot.hold('d', []);
    pilot.hold('w', []);
    expect(last()).toEqual(NEUTRAL);
  });

  it('numbers what it says, under the lease that counts, by the robot’s clock', () => {
    vi.advanceTimersByTime(200);
    lease = 6;
    now = 101;
    vi.advanceTimersByTime(100);
    expect(said.map(({ sequence }) => sequence)).toEqual([1, 2, 3]);
    expect(said.map((one) => one.lease)).toEqual([5, 5, 6]);
    expect(said.map(({ taken }) => taken)).toEqual([100, 100, 101]);
  });

  it.each(['visibilitychange', 'blur', 'pagehide'])('lets go at once, with one neutral, on %s', (event) => {
    pilot.hold('w', forwards);
    vi.advanceTimersByTime(500);
    lease = null;
    const before = said.length;
    (event === 'visibilitychange' ? page : window).dispatchEvent(new Event(event));
    expect(said).toHaveLength(before + 1);
    expect(last()).toEqual(NEUTRAL);
    vi.advanceTimersByTime(5000);
    expect(said).toHaveLength(before + 1);
  });

  it('does not go on by itself with what was held before', () => {
    pilot.hold('w', forwards);
    vi.advanceTimersByTime(500);
    lease = null;
    vi.advanceTimersByTime(500);
    lease = 7;
    said.length = 0;
    vi.advanceTimersByTime(500);
    expect(said.length).toBeGreaterThan(0);
    expect(said.every(({ axes }) => axes.every((value) => value === 0))).toBe(true);
  });

  it('says nothing while the robot’s clock is not known', () => {
    now = NaN;
    vi.advanceTimersByTime(500);
    expect(said).toEqual([]);
  });
});

describe('axes', () => {
  const at = (axis: number, value: number) => NEUTRAL.map((zero, place) => (place === axis ? value : zero)) as unknown as Axes;

  it('adds up what is held, within its ends; opposites cancel out', () => {
    expect(combine([forwards, forwards, [{ axis: YAW, amount: 1 }], [{ axis: YAW, amount: -1 }]])).toEqual(at(X, 1));
  });

  it('grows by steps, and falls back at once', () => {
    expect(approach(NEUTRAL, at(Z, -1), 0.2)[Z]).toBeCloseTo(-0.2, 9);
    expect(approach(at(Z, -0.9), at(Z, -1), 0.2)[Z]).toBe(-1);
    expect(approach(at(Z, -1), at(Z, -0.3), 0.2)[Z]).toBe(-0.3);
    expect(approach(at(Z, -1), NEUTRAL, 0.2)[Z]).toBe(0);
    expect(approach(at(Z, -1), at(Z, 1), 0.2)[Z]).toBeCloseTo(0.2, 9);
  });
});
