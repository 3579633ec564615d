import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { PITCH, ROLL, X, Y, YAW, Z, type Push } from '../src/drive/axes';
import { pushesOf, STANDARD, type Button } from '../src/drive/gamepad';
import { Handling, TRIM_MOST } from '../src/drive/handling.svelte';
import { actionOf } from '../src/drive/keys';
import { Pads } from '../src/drive/pads.svelte';
import { Pilot } from '../src/drive/pilot.svelte';
import { pad as seenPad } from './gamepads';

describe('keys', () => {
  beforeEach(() => vi.stubGlobal('Element', EventTarget));
  afterEach(() => vi.unstubAllGlobals());

  const press = (code: string, more: object = {}) =>
    actionOf({ code, shiftKey: false, ctrlKey: false, metaKey: false, altKey: false, target: null, ...more } as KeyboardEvent);
  const push = (axis: number, amount: number) => ({ do: 'push', push: { axis, amount } });

  it('reach all six degrees both ways', () => {
    const pushes = 'KeyW KeyS KeyE KeyQ KeyF KeyR ArrowRight ArrowLeft ArrowUp ArrowDown KeyD KeyA'.split(' ').map((code) => press(code));
    const both = (axis: number) => [push(axis, 1), push(axis, -1)];
    expect(pushes).toEqual([X, Y, Z, ROLL, PITCH, YAW].flatMap(both));
  });

  it('drive with shift and the arrows alone, too', () => {
    const shifted = ['ArrowUp', 'ArrowDown', 'ArrowRight', 'ArrowLeft'].map((code) => press(code, { shiftKey: true }));
    expect(shifted).toEqual([push(X, 1), push(X, -1), push(YAW, 1), push(YAW, -1)]);
    expect(press('KeyW', { shiftKey: true })).toEqual(push(X, 1));
  });

  it('choose the speed and the holds', () => {
    expect(press('Digit4')).toEqual({ do: 'speed', speed: 4 });
    expect(press('Numpad9')).toEqual({ do: 'speed', speed: 9 });
    expect(press('Digit0')).toBeNull();
    expect(press('KeyG')).toEqual({ do: 'hold', loop: 'depth' });
    expect(press('KeyH')).toEqual({ do: 'hold', loop: 'heading' });
  });

  it('leave the browser its own', () => {
    expect(['ctrlKey', 'metaKey', 'altKey'].map((modifier) => press('KeyW', { [modifier]: true }))).toEqual([null, null, null]);
    expect(press('KeyX')).toBeNull();
  });
});

const pad = (axes: number[], down: number[] = [], more: object = {}) => seenPad(axes, down, { id: 'Test pad (Vendor: 0000)', ...more }) as Gamepad;

describe('a gamepad', () => {
  const of = (axes: number[], ...down: number[]) => new Map(pushesOf(pad(axes, down), STANDARD).map(({ axis, amount }: Push) => [axis, amount]));

  it('drives all six degrees', () => {
    expect(of([0, -1, 0, 0])).toEqual(new Map([[Z, -1]]));
    expect(of([1, 0, 0, 0])).toEqual(new Map([[YAW, 1]]));
    expect(of([0, 0, 0, -1])).toEqual(new Map([[X, 1]]));
    expect(of([0, 0, -1, 0])).toEqual(new Map([[Y, -1]]));
    expect(of([0, 0, 0, 0], 12, 15)).toEqual(new Map([[PITCH, 1], [ROLL, 1]]));
  });

  it('rests in a dead zone', () => {
    expect(of([0.1, -0.1, 0.19, 0])).toEqual(new Map());
    expect(of([NaN, 0, 0, 0])).toEqual(new Map());
  });
});

describe('Pads', () => {
  let there: (Gamepad | null)[];
  let page: EventTarget;
  let pilot: Pilot;
  let pads: Pads;
  let lease: number | null;
  let pushed: Button[];
  let ends: (() => void)[];

  beforeEach(() => {
    vi.useFakeTimers();
    there = [null];
    page = new EventTarget();
    lease = 1;
    pushed = [];
    vi.stubGlobal('window', page);
    vi.stubGlobal('document', new EventTarget());
    vi.stubGlobal('history', { pushState: () => undefined });
    vi.stubGlobal('location', { href: '' });
    vi.stubGlobal('navigator', { getGamepads: () => there });
    pilot = new Pilot({ say: () => undefined, now: () => 0, lease: () => lease, keeps: () => false });
    pads = new Pads(pilot, (button) => pushed.push(button));
    ends = [pilot.start(), pads.start()];
  });

  afterEach(() => {
    for (const end of ends) end();
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  async function show(one: Gamepad | null): Promise<void> {
    there = [one];
    if (one !== null && pads.name === null) page.dispatchEvent(new Event('gamepadconnected'));
    await vi.dynamicImportSettled();
    vi.advanceTimersByTime(50);
  }

  it('drive once the sticks have been in the middle', async () => {
    await show(pad([0, 0, 0, -1]));
    expect([pads.name, pads.waits, pilot.axes[X]]).toEqual(['Test pad', true, 0]);
    await show(pad([0, 0, 0, 0]));
    await show(pad([0, 0, 0, -1]));
    expect(pads.waits).toBe(false);
    expect(pilot.axes[X]).toBeGreaterThan(0);
  });

  it.each([
    ['is not listed any more', null],
    ['says that it is off', pad([0, 0, 0, -1], [], { connected: false })],
  ])('let go, and tell, when one %s', async (_, gone) => {
    await show(pad([0, 0, 0, 0]));
    await show(pad([0, 0, 0, -1]));
    expect(pilot.axes[X]).toBeGreaterThan(0);
    await show(gone);
    expect([pilot.axes[X], pads.name]).toEqual([0, null]);
    expect(pads.notice).toContain('Test pad disconnected');
    await show(pad([0, 0, 0, -1]));
    expect([pilot.axes[X], pads.waits]).toEqual([0, true]);
    expect(pads.notice).toContain('Release');
  });

  it('do not go on with what was held while nobody looked', async () => {
    await show(pad([0, 0, 0, 0]));
    await show(pad([0, 0, 0, -1]));
    lease = null;
    vi.advanceTimersByTime(100);
    lease = 2;
    vi.advanceTimersByTime(500);
    expect([pilot.axes[X], pads.waits]).toEqual([0, true]);
  });

  it('tell of a button once, when it goes down', async () => {
    await show(pad([0, 0, 0, 0], [1]));
    expect(pushed).toEqual([]);
    await show(pad([0, 0, 0, 0]));
    await show(pad([0, 0, 0, 0], [1, 5]));
    await show(pad([0, 0, 0, 0], [1]));
    expect(pushed).toEqual(['stop', 'faster']);
  });

  it('do not use one of another layout', async () => {
    await show(pad([0, 0, 0, -1], [], { mapping: '' }));
    expect([pads.name, pilot.axes[X]]).toEqual([null, 0]);
    expect(pads.notice).toContain('assign its sticks');
  });
});

describe('Handling', () => {
  it('keeps to its steps and ends', () => {
    const handling = new Handling();
    handling.setSpeed(12);
    expect(handling.share).toBe(1);
    handling.setSpeed(0);
    expect(handling.speed).toBe(1);
    handling.setTrim(Z, 5);
    expect(handling.trim[Z]).toBeCloseTo(TRIM_MOST, 9);
    for (let step = 0; step < 3; step += 1) handling.setTrim(Y, handling.trim[Y] + 0.02);
    for (let step = 0; step < 3; step += 1) handling.setTrim(Y, handling.trim[Y] - 0.02);
    expect(handling.trim[Y]).toBe(0);
    handling.resetTrim();
    expect(handling.trimmed).toBe(false);
  });

  it('outlasts a reload, and is not led astray by what it finds', () => {
    const kept = new Map<string, string>();
    vi.stubGlobal('sessionStorage', { getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => kept.set(key, value) });
    const handling = new Handling();
    handling.setSpeed(2);
    handling.setTrim(ROLL, -0.1);
    expect([new Handling().speed, new Handling().trim[ROLL]]).toEqual([2, -0.1]);
    for (const key of kept.keys()) kept.set(key, '{"speed":"fast","trim":[null,9,"x"]}');
    const other = new Handling();
    expect(other.share).toBeGreaterThan(0);
    expect(other.trim.every((value) => Math.abs(value) <= TRIM_MOST)).toBe(true);
    vi.unstubAllGlobals();
  });
});
