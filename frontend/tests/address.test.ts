import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { rememberAddress, Router } from '../src/router.svelte';

describe('the address', () => {
  afterEach(() => vi.unstubAllGlobals());

  it('is the same until somebody goes on', () => {
    const location = { hash: '#/comm-tests' };
    vi.stubGlobal('location', location);
    const stillHere = rememberAddress();
    expect(stillHere()).toBe(true);
    location.hash = '#/operate';
    expect(stillHere()).toBe(false);
  });
});

describe('what is seen', () => {
  let stack: string[];
  let changed: () => void;

  beforeEach(() => {
    vi.useFakeTimers();
    stack = ['#/sessions/3?at=12.5&signals=depth.depth,imu.yaw'];
    const location = {
      get hash() {
        return stack.at(-1) ?? '';
      },
      set hash(hash: string) {
        stack.push(hash);
      },
      get href() {
        return `http://turtle:8000/${this.hash}`;
      },
    };
    vi.stubGlobal('location', location);
    vi.stubGlobal('history', {
      state: null,
      pushState: (_state: null, _title: string, hash: string) => stack.push(hash),
      replaceState: (_state: null, _title: string, hash: string) => (stack[stack.length - 1] = hash),
    });
    vi.stubGlobal('window', { addEventListener: (_name: string, read: () => void) => (changed = read) });
  });

  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  it('is read from the address, and nonsense in it is no number', () => {
    const router = new Router();
    expect([router.current, router.within, router.number('at')]).toEqual(['sessions', ['3'], 12.5]);
    expect(router.seen.get('signals')).toBe('depth.depth,imu.yaw');
    expect(router.number('at', 0, 10)).toBeNull();
    for (const nonsense of ['x', '', ' ', 'Infinity', '1e999', '%']) {
      stack = [`#/sessions/3?at=${nonsense}`];
      changed();
      expect(router.number('at')).toBeNull();
    }
  });

  it('is written at once, and when it rests again, in place of what was there', () => {
    const router = new Router();
    router.show({ at: 13, signals: null });
    expect(stack).toEqual(['#/sessions/3?at=13']);
    router.show({ at: 13.5 });
    router.show({ at: 14 });
    expect(router.address).toBe('http://turtle:8000/#/sessions/3?at=14');
    expect(stack).toEqual(['#/sessions/3?at=13']);
    vi.runAllTimers();
    expect(stack).toEqual(['#/sessions/3?at=14']);
  });

  it('is a step to which "back" returns', () => {
    const router = new Router();
    router.show({ at: 13, signals: null });
    router.show({ from: 1, to: 2 }, true);
    expect(stack).toEqual(['#/sessions/3?at=13', '#/sessions/3?at=13&from=1&to=2']);
    stack.pop();
    changed();
    expect(router.number('from')).toBeNull();
  });

  it('is read anew where the same address is opened once more', () => {
    const router = new Router();
    const before = router.seen;
    router.open(location.hash);
    expect(router.seen).not.toBe(before);
    router.open('#/tune/parameters?parameter=depth_pid.kp');
    expect([router.current, router.seen.get('parameter')]).toEqual(['tune', 'depth_pid.kp']);
  });

  it('never takes back who has gone on', () => {
    const router = new Router();
    router.show({ at: 13 });
    router.show({ at: 14 });
    stack.push('#/operate');
    vi.runAllTimers();
    expect(stack.at(-1)).toBe('#/operate');
  });
});
