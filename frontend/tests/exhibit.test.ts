import { describe, expect, it } from 'vitest';
import { doing, following } from '../src/flight/exhibit';
import type { State } from '../src/generated/topics';

const all = { camera: true, turtle: true, curve: true };
const state = (mode: State['mode'], on = true) => ({ mode, loops: [{ name: 'depth', on, set_point: 0.5 }] }) as unknown as State;

describe('the views of an exhibit', () => {
  it('follow each other in a circle', () => {
    expect([following('turtle', all), following('camera', all), following('curve', all)]).toEqual(['camera', 'curve', 'turtle']);
  });

  it('leave out what is not there', () => {
    expect(following('turtle', { ...all, camera: false })).toBe('curve');
    expect(following('curve', { camera: false, turtle: false, curve: true })).toBe('curve');
  });
});

describe('what the turtle does', () => {
  it('is said in a few words', () => {
    expect(doing(null, null, 0)).toBe('Waiting for the turtle');
    expect(doing(state('disarmed'), null, 0.2)).toBe('It rests');
    expect(doing(state('failsafe'), null, 0)).toBe('It has stopped by itself');
    expect(doing(state('automatic'), null, 0.1)).toBe('It dives');
    expect(doing(state('automatic'), null, -0.1)).toBe('It rises');
    expect(doing(state('automatic'), null, 0.01)).toBe('It holds its depth by itself, at 0.5 m');
    expect(doing(state('automatic', false), null, 0)).toBe('It swims by itself');
    expect(doing(state('manual'), null, 0)).toBe('Somebody steers it');
  });
});
