import { beforeEach, describe, expect, it } from 'vitest';
import { Control } from '../src/live/control.svelte';
import type { ControlState } from '../src/api';
import type { You } from '../src/live/messages';

let asked: string[];
let seen: boolean;
let control: Control;

const OPERATOR: You = { name: 'me', role: 'operator', client: 1 };
const other = { client: 2, name: 'Safari on iPad' };
const message = (said: Partial<ControlState> = {}): ControlState => ({
  epoch: 1,
  holder: null,
  ...said,
});

beforeEach(() => {
  asked = [];
  seen = true;
  const call = (name: string) => () => {
    asked.push(name);
    return Promise.resolve(null);
  };
  const calls = { take: call('take'), release: call('release'), takeOver: call('take over') };
  control = new Control(calls, () => seen);
});

describe('a page and the control', () => {
  it('takes what is free where nobody ever had it', () => {
    control.greet(OPERATOR);
    control.hear(message());
    control.hear(message());
    expect(asked).toEqual(['take']);
  });

  it('waits until it is seen', () => {
    seen = false;
    control.greet(OPERATOR);
    control.hear(message());
    expect(asked).toEqual([]);
    seen = true;
    control.consider();
    expect(asked).toEqual(['take']);
  });

  it('does not take what somebody else has let go of', () => {
    control.greet(OPERATOR);
    control.hear(message({ holder: other }));
    control.hear(message());
    expect(asked).toEqual([]);
  });

  it('takes over from another page of this browser, as after a reload', () => {
    control.greet(OPERATOR);
    control.hear(message({ holder: { client: 9, name: 'me' } }));
    control.hear(message());
    expect(asked).toEqual(['take']);
  });

  it('does not take back what was given up, not even over another connection', async () => {
    control.greet(OPERATOR);
    control.hear(message({ holder: { client: 1, name: 'me' } }));
    await control.release();
    control.hear(message());
    control.leave();
    control.greet(OPERATOR);
    control.hear(message());
    expect(asked).toEqual(['release']);
  });

  it.each(['take', 'takeOver'] as const)('takes control back over another connection after %s ended a release', async (how) => {
    const mine = message({ holder: { client: 1, name: 'me' } });
    control.greet(OPERATOR);
    control.hear(mine);
    await control.release();
    await control[how]();
    control.hear(mine);
    control.leave();
    asked = [];
    control.greet(OPERATOR);
    control.hear(message());
    expect(asked).toEqual(['take']);
  });

  it('takes control over only where it is told to, and says when somebody took it from here', async () => {
    control.greet(OPERATOR);
    control.hear(message({ holder: other }));
    expect(asked).toEqual([]);
    await control.takeOver();
    expect(asked).toEqual(['take over']);
    control.hear(message({ holder: { client: 1, name: 'me' } }));
    expect(control.lostTo).toBeNull();
    control.hear(message({ holder: other }));
    expect(control.lostTo).toBe('Safari on iPad');
    control.forgetLoss();
    expect(control.lostTo).toBeNull();
    control.hear(message({ holder: { client: 1, name: 'me' } }));
    control.hear(message());
    expect(control.lostTo).toBeNull();
  });

  it('leaves it to others where it is a viewer’s', () => {
    control.greet({ ...OPERATOR, role: 'viewer' });
    control.hear(message());
    expect(asked).toEqual([]);
    expect(control.barred).toBe('Viewers can watch and press STOP.');
  });

  it('says in words why it cannot command', () => {
    expect(control.barred).toContain('not known yet');
    control.greet(OPERATOR);
    control.hear(message({ holder: other }));
    expect(control.barred).toContain('Safari on iPad');
    control.hear(message());
    expect(control.barred).toContain('Take control');
    control.hear(message({ holder: { client: 1, name: 'me' } }));
    expect(control.barred).toBeNull();
    control.leave();
    expect(control.barred).not.toBeNull();
  });
});
