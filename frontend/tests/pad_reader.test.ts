import { describe, expect, it } from 'vitest';
import { X, YAW, Z, type Axis } from '../src/drive/axes';
import { STANDARD, UNASSIGNED, type PadProfile } from '../src/drive/gamepad';
import { padKey, PadReader, SILENT_NOTICE, SILENT_RELEASE, type PadList, type PadLook, type SeenPad } from '../src/drive/padReader';
import { noticeOf } from '../src/drive/padWatch';
import { pad } from './gamepads';

const FORWARDS = [0, 0, 0, -1];
const REST = [0, 0, 0, 0];

/** Gamepads that are looked at ten times a second. */
class Desk {
  at = 0;
  choice: string | null = null;
  steers = true;
  readonly profiles = new Map<string, PadProfile>();
  readonly #reader = new PadReader(
    ({ id, mapping }) => this.profiles.get(id) ?? (mapping === 'standard' ? STANDARD : null),
    () => this.choice,
  );

  look(...list: PadList): PadLook {
    this.at += 0.1;
    return this.#reader.look(list, this.at, this.steers);
  }

  /** The last of the looks in so many seconds. */
  wait(seconds: number, list: (at: number) => PadList): PadLook {
    let seen = this.look(...list(this.at));
    for (const end = this.at + seconds; this.at < end; ) seen = this.look(...list(this.at));
    return seen;
  }
}

const pushOf = (seen: PadLook, axis: Axis) => seen.pushes.find((push) => push.axis === axis)?.amount ?? 0;
const id = (name: string, index: number, axes = REST, down: number[] = []): SeenPad => pad(axes, down, { id: `${name} (STANDARD GAMEPAD)`, index });

describe('which gamepad drives', () => {
  it('1: the only one, after it has been seen at rest', () => {
    const desk = new Desk();
    expect(desk.look(pad(FORWARDS))).toMatchObject({ waits: true, pushes: [] });
    expect(desk.look(pad(REST)).waits).toBe(false);
    expect(pushOf(desk.look(pad(FORWARDS)), X)).toBeCloseTo(1);
  });

  it('2: not a 3D mouse that is listed first and lies still', () => {
    const desk = new Desk();
    desk.look(id('Space mouse', 0), id('Real pad', 1));
    const seen = desk.look(id('Space mouse', 0), id('Real pad', 1, FORWARDS));
    expect(seen.pad?.index).toBe(1);
    expect(pushOf(seen, X)).toBeCloseTo(1);
  });

  it('3: a headset takes nothing, before the gamepad or while it drives, and is not told of', () => {
    const desk = new Desk();
    const headset = pad([], [], { id: 'Office headset', mapping: '', buttons: [] });
    const real = (axes: number[]) => pad(axes, [], { index: 1 });
    desk.look(headset, real(REST));
    const seen = desk.look(headset, real(FORWARDS));
    expect(pushOf(seen, X)).toBeCloseTo(1);
    expect(noticeOf(seen)).toBe('');
    expect(noticeOf(new Desk().look(headset))).toBe('');
    // One that comes while the gamepad drives.
    const late = desk.look(real(FORWARDS), { ...headset, index: 0 });
    expect(late.pad?.index).toBe(1);
    expect(pushOf(late, X)).toBeCloseTo(1);
  });

  it('4: another one takes over while the first rests, and not while it is held', () => {
    const desk = new Desk();
    desk.look(id('First', 0), id('Second', 1));
    desk.look(id('First', 0, FORWARDS), id('Second', 1));
    expect(desk.look(id('First', 0, FORWARDS), id('Second', 1, [1, 0, 0, 0])).pad?.index).toBe(0);
    const seen = desk.look(id('First', 0), id('Second', 1, [1, 0, 0, 0]));
    expect(seen.pad?.index).toBe(1);
    expect([pushOf(seen, X), pushOf(seen, YAW)]).toEqual([0, 1]);
  });

  it('5: the chosen one alone of two of the same name', () => {
    const desk = new Desk();
    const both = (axes: number[], others: number[]): PadList => [pad(axes), pad(others, [], { index: 3 })];
    desk.choice = padKey(pad(REST, [], { index: 3 }), both(REST, REST));
    desk.look(...both(REST, REST));
    expect(desk.look(...both(FORWARDS, REST))).toMatchObject({ pad: { index: 3 }, pushes: [] });
    expect(pushOf(desk.look(...both(FORWARDS, FORWARDS)), X)).toBeCloseTo(1);
  });

  it('6: holes in the list do no harm', () => {
    const desk = new Desk();
    const holed: (SeenPad | null | undefined)[] = [null, undefined, pad(REST, [], { index: 2 })];
    expect(desk.look(...holed)).toMatchObject({ pad: { index: 2 }, waits: false });
    expect(desk.look(null, undefined)).toMatchObject({ pad: null, gone: pad(REST).id });
  });

  it('7: one pulled out lets go, and in again has to rest first', () => {
    const desk = new Desk();
    desk.look(pad(REST));
    desk.look(pad(FORWARDS));
    expect(desk.look(null)).toMatchObject({ pad: null, pushes: [], gone: pad(REST).id });
    expect(desk.look(pad(FORWARDS))).toMatchObject({ waits: true, pushes: [], joined: true });
    expect(desk.look(pad(REST)).gone).toBeNull();
    expect(pushOf(desk.look(pad(FORWARDS)), X)).toBeCloseTo(1);
  });

  it('8: one that is listed as gone is not there, and another kind at its place is a new one', () => {
    const desk = new Desk();
    desk.look(pad(REST));
    desk.look(pad(FORWARDS));
    expect(desk.look(pad(FORWARDS, [], { connected: false }))).toMatchObject({ pad: null, pushes: [] });
    desk.look(pad(REST));
    expect(desk.look(pad(FORWARDS, [], { id: 'Other (STANDARD GAMEPAD)' }))).toMatchObject({ waits: true, pushes: [], gone: pad(REST).id });
  });

  it('9: one without a name drives', () => {
    const desk = new Desk();
    desk.look(pad(REST, [], { id: '' }));
    expect(pushOf(desk.look(pad(FORWARDS, [], { id: '' })), X)).toBeCloseTo(1);
  });

  it('10: one of no known layout drives nothing until its sticks are assigned', () => {
    const desk = new Desk();
    const joystick = (axes: number[]) => pad(axes, [], { id: '0001-0002-Generic USB Joystick', mapping: '' });
    const seen = desk.look(joystick([0, -1, -1, 0, 0, -1]));
    expect(seen).toMatchObject({ pad: null, pushes: [] });
    expect(noticeOf(seen)).toContain('Generic USB Joystick: assign its sticks');
    desk.profiles.set(joystick([]).id, { ...UNASSIGNED, motions: STANDARD.motions.map((motion, axis) => (axis === (Z as number) ? motion : { stick: null, less: null, more: null })) });
    desk.look(joystick([0, 0, -1, 0, 0, -1]));
    expect(pushOf(desk.look(joystick([0, -1, -1, 0, 0, -1])), Z)).toBeCloseTo(-1);
  });
});

describe('sticks', () => {
  it.each([0.16, 0.19])('11, 12: one that rests at %f moves nothing, and the gamepad drives', (value) => {
    const desk = new Desk();
    expect(desk.look(pad([value, -0.02, 0, 0]))).toMatchObject({ waits: false, pushes: [] });
    const seen = desk.look(pad([value, -0.02, 0, -1]));
    expect(seen.pushes).toHaveLength(1);
    expect(pushOf(seen, X)).toBeCloseTo(1);
  });

  it('13: one that rests beyond its dead zone is named with its value', () => {
    const seen = new Desk().look(pad([0.27, 0, 0, 0]));
    expect(seen).toMatchObject({ waits: true, pushes: [], offRest: [{ axis: YAW, value: 0.27 }] });
    expect(noticeOf(seen)).toContain('Turn stands at +0.27');
  });

  it('14: one that gives no number rests, and the others drive', () => {
    const desk = new Desk();
    expect(desk.look(pad([NaN, Infinity, 0, 0])).pushes).toEqual([]);
    expect(desk.look(pad([NaN, 0, 0, -1])).pushes).toMatchObject([{ axis: X }]);
    expect(desk.look(pad([])).pushes).toEqual([]);
  });

  it('15: triggers that are axes rest at an end, and one that has not told yet has to be pressed first', () => {
    const desk = new Desk();
    expect(desk.look(pad([0, 0, 0, 0, -1, -1]))).toMatchObject({ waits: false, pushes: [] });
    const motions = STANDARD.motions.map((motion, axis) =>
      axis === (X as number) ? { ...motion, stick: { index: 5, invert: false, rest: -1 as const, dead: 0.2, curve: 0 } } : motion,
    );
    const own = new Desk();
    own.profiles.set(pad([]).id, { ...STANDARD, motions });
    // Linux gives 0 for a trigger that nobody has touched since it was plugged in.
    expect(own.look(pad([0, 0, 0, 0, 0, 0]))).toMatchObject({ waits: true, pushes: [] });
    own.look(pad([0, 0, 0, 0, -1, -1]));
    expect(pushOf(own.look(pad([0, 0, 0, 0, -1, 1])), X)).toBeCloseTo(1);
  });
});

describe('16: a gamepad that froze while a stick was held', () => {
  const frozen = (): PadList => [pad([0, 0, 0, -0.9], [], { timestamp: 1000 })];

  function driving(): Desk {
    const desk = new Desk();
    desk.look(pad(REST));
    return desk;
  }

  it('is told of, then lets go, and has to rest before it drives again', () => {
    const desk = driving();
    expect(noticeOf(desk.wait(SILENT_NOTICE - 0.3, frozen))).toBe('');
    const noticed = desk.wait(0.5, frozen);
    expect(noticeOf(noticed)).toContain('Nothing new from the gamepad for 2 s');
    expect(pushOf(noticed, X)).toBeGreaterThan(0.8);
    const over = desk.wait(SILENT_RELEASE - SILENT_NOTICE, frozen);
    expect(over).toMatchObject({ pushes: [], waits: true });
    expect(noticeOf(over)).toContain('released');
    expect(desk.wait(60, frozen).pushes).toEqual([]);
    // Back within reach, with the stick as it is.
    expect(desk.look(pad(FORWARDS, [], { timestamp: 70_000 }))).toMatchObject({ waits: true, pushes: [] });
    desk.look(pad(REST));
    expect(pushOf(desk.look(pad(FORWARDS)), X)).toBeCloseTo(1);
  });

  it('is told from a held stick by the time stamp, where the browser renews it', () => {
    const desk = driving();
    const seen = desk.wait(30, (at) => [pad([0, 0, 0, -0.9], [], { timestamp: at * 1000 })]);
    expect(seen.silence).toBe(0);
    expect(pushOf(seen, X)).toBeGreaterThan(0.8);
  });

  it('is told from a held stick by a hand’s trembling, where there are no time stamps', () => {
    const desk = driving();
    const seen = desk.wait(30, (at) => [pad([0.004 * (Math.floor(at) % 2), 0, 0, -1])]);
    expect(noticeOf(seen)).toBe('');
    expect(pushOf(seen, X)).toBeCloseTo(1);
  });

  it('may lie still for as long as it likes while it rests', () => {
    const desk = driving();
    expect(noticeOf(desk.wait(60, () => [pad(REST)]))).toBe('');
    expect(pushOf(desk.look(pad(FORWARDS)), X)).toBeCloseTo(1);
  });

  it('leaves the drive to another one', () => {
    const desk = new Desk();
    desk.look(pad(REST), id('Spare', 1));
    desk.wait(6, () => [...frozen(), id('Spare', 1)]);
    expect(desk.look(...frozen(), id('Spare', 1, FORWARDS)).pad?.index).toBe(1);
  });
});

describe('buttons', () => {
  it('count once, when they go down, and not where they are down at first', () => {
    const desk = new Desk();
    expect(desk.look(pad(REST, [1])).pressed).toEqual([]);
    expect(desk.look(pad(REST)).pressed).toEqual([]);
    expect(desk.look(pad(REST, [1, 5])).pressed).toEqual(['stop', 'faster']);
    expect(desk.look(pad(REST, [1])).pressed).toEqual([]);
  });

  it('say STOP even while the sticks do not count', () => {
    const desk = new Desk();
    desk.look(pad(FORWARDS));
    expect(desk.look(pad(FORWARDS, [1]))).toMatchObject({ waits: true, pressed: ['stop'] });
  });

  it('nothing of what was held counts while nobody looks, nor after', () => {
    const desk = new Desk();
    desk.look(pad(REST));
    desk.look(pad(FORWARDS));
    desk.steers = false;
    desk.look(pad(FORWARDS));
    desk.steers = true;
    expect(desk.look(pad(FORWARDS))).toMatchObject({ waits: true, pushes: [] });
  });
});
