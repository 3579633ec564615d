import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { PITCH, X, Z } from '../src/drive/axes';
import { amountOf, pushesOf, STANDARD, UNASSIGNED, type StickAxis } from '../src/drive/gamepad';
import { fileOf, profileOf, readPadFile, storeProfile } from '../src/drive/padProfiles';
import { assigned, cleared, movedAxis } from '../src/pages/gamepads/assigning';
import { pad } from './gamepads';

const REST = [0, 0, 0, 0];

describe('dead zone and curve', () => {
  const stick: StickAxis = { index: 0, invert: false, rest: 0, dead: 0.2, curve: 0 };

  it('begin at nothing and end at full', () => {
    const at = (value: number, more: Partial<StickAxis> = {}) => amountOf(pad([value]), { ...stick, ...more });
    expect([at(0.2), at(1), at(-1), at(1, { invert: true })]).toEqual([0, 1, -1, -1]);
    expect(at(0.21)).toBeLessThan(0.02);
    expect(at(1.4)).toBe(1);
    expect(at(0.6)).toBeCloseTo(0.5);
    expect(at(0.6, { curve: 1 })).toBeCloseTo(0.125);
    expect(at(1, { curve: 1 })).toBe(1);
    expect([at(1, { rest: -1 }), at(-1, { rest: -1 }), at(-1, { rest: 1 })]).toEqual([1, 0, -1]);
  });
});

describe('assigning', () => {
  it('takes the axis that is moved farthest, its direction, and where it rests', () => {
    expect(movedAxis(pad(REST), pad([0.1, 0.45, 0, 0]))).toBeNull();
    expect(movedAxis(pad([0.19, 0, 0, 0]), pad([0.3, -0.9, 0, 0]))).toMatchObject({ index: 1, invert: true, rest: 0 });
    expect(movedAxis(pad([0, -1]), pad([0, 0.5]))).toMatchObject({ index: 1, invert: false, rest: -1 });
    expect(movedAxis(pad([NaN, 0]), pad([NaN, 1]))).toMatchObject({ index: 1 });
  });

  it('takes from others what it gives', () => {
    const moved = assigned(STANDARD, { axis: Z, source: 'stick' }, pad(REST), pad([0, 0, 0, 1]));
    expect(moved?.motions.map(({ stick }) => stick?.index ?? null)).toEqual([null, 2, 3, null, null, 0]);
    const pressed = assigned(STANDARD, { button: 'snapshot' }, pad(REST), pad(REST, [12]));
    expect(pressed).toMatchObject({ buttons: { snapshot: 12 }, motions: { [PITCH]: { less: 13, more: null } } });
    expect(assigned(STANDARD, { button: 'snapshot' }, pad(REST, [12]), pad(REST, [12]))).toBeNull();
    expect(cleared(STANDARD, { button: 'stop' }).buttons.stop).toBeNull();
    expect(cleared(STANDARD, { axis: X, source: 'stick' })).toMatchObject({ motions: { [X]: { stick: null } } });
  });

  it('moves the robot as assigned', () => {
    const own = assigned(UNASSIGNED, { axis: X, source: 'less' }, pad(REST), pad(REST, [7]));
    expect(pushesOf(pad(REST, [7]), own ?? UNASSIGNED)).toEqual([{ axis: X, amount: -1 }]);
  });
});

describe('files', () => {
  const good = JSON.parse(fileOf('Pad A', STANDARD)) as Record<string, unknown>;
  const read = (change: object) => readPadFile(JSON.stringify({ ...good, ...change }));
  const motion = (more: object) => ({ motions: [{ stick: { index: 3, invert: true, rest: 0, dead: 0.2, curve: 0, ...more }, less: null, more: null }, ...STANDARD.motions.slice(1)] });

  it('come back as they went', () => {
    expect(readPadFile(fileOf('Pad A', STANDARD))).toEqual({ id: 'Pad A', profile: STANDARD });
  });

  it.each([
    ['no JSON', () => readPadFile('<html>'), 'not JSON'],
    ['a list', () => readPadFile('[]'), 'not a file of a gamepad'],
    ['nothing', () => readPadFile('null'), 'not a file of a gamepad'],
    ['another file', () => read({ format: 'mucat-layout' }), 'not a file of a gamepad'],
    ['a later version', () => read({ version: 2 }), 'another version'],
    ['no buttons', () => read({ buttons: null }), 'missing'],
    ['five motions', () => read({ motions: STANDARD.motions.slice(1) }), '6 motions'],
    ['an unknown action', () => read({ buttons: { ...STANDARD.buttons, explode: 3 } }), '“explode”'],
    ['half a button', () => read({ buttons: { ...STANDARD.buttons, stop: 1.5 } }), '“STOP”'],
    ['a button of two tasks', () => read({ buttons: { ...STANDARD.buttons, stop: 12 } }), 'button 12 has two tasks'],
    ['a dead zone of all', () => read(motion({ dead: 1 })), 'dead zone of “Forwards”'],
    ['a curve of text', () => read(motion({ curve: '1' })), 'curve of “Forwards”'],
    ['a stick without a number', () => read(motion({ index: null })), '“Forwards” is not complete'],
    ['a stick below zero', () => read(motion({ index: -1 })), '“Forwards” has a number'],
    ['a motion of text', () => read({ motions: ['up', ...STANDARD.motions.slice(1)] }), '“Forwards” is not complete'],
  ])('of %s are refused in words', (_, refused, words) => {
    const outcome = refused();
    expect('problem' in outcome ? outcome.problem : '').toContain(words);
  });
});

describe('what the browser remembers', () => {
  let stored: Map<string, string>;

  beforeEach(() => {
    stored = new Map();
    vi.stubGlobal('localStorage', { getItem: (key: string) => stored.get(key) ?? null, setItem: (key: string, value: string) => stored.set(key, value) });
  });
  afterEach(() => vi.unstubAllGlobals());

  it('is kept for each gamepad', () => {
    const own = cleared(STANDARD, { button: 'faster' });
    storeProfile('Pad A', own);
    storeProfile('', UNASSIGNED);
    expect(profileOf({ id: 'Pad A', mapping: 'standard' })).toEqual(own);
    expect(profileOf({ id: '', mapping: '' })).toEqual(UNASSIGNED);
    expect(profileOf({ id: 'Pad B', mapping: 'standard' })).toEqual(STANDARD);
    expect(profileOf({ id: 'Pad B', mapping: '' })).toBeNull();
    expect(profileOf({ id: 'constructor', mapping: '' })).toBeNull();
    storeProfile('Pad A', null);
    expect(profileOf({ id: 'Pad A', mapping: 'standard' })).toEqual(STANDARD);
  });

  it.each(['{', '[1]', '{"Pad A":{"motions":3}}', '"text"'])('is not led astray by %s', (text) => {
    stored.set('mucat-gamepads', text);
    expect(profileOf({ id: 'Pad A', mapping: 'standard' })).toEqual(STANDARD);
  });
});
