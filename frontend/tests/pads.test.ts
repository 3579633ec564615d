import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Pads } from '../src/drive/pads.svelte';
import { Pilot } from '../src/drive/pilot.svelte';

let plugged: (Gamepad | null)[];
let page: EventTarget;
let pads: Pads;
let end: () => void;

/** A gamepad whose sticks are in the middle. */
const gamepad = (index: number, id: string, connected = true) =>
  ({ id, index, connected, mapping: 'standard', axes: [0, 0, 0, 0], buttons: [] }) as unknown as Gamepad;

async function start(): Promise<void> {
  const pilot = new Pilot({ say: () => undefined, now: () => 0, lease: () => 1, keeps: () => false });
  pads = new Pads(pilot, () => undefined);
  end = pads.start();
  await vi.dynamicImportSettled();
}

beforeEach(() => {
  vi.useFakeTimers();
  plugged = [];
  page = new EventTarget();
  vi.stubGlobal('window', page);
  vi.stubGlobal('history', { pushState: () => undefined });
  vi.stubGlobal('location', { href: '' });
  vi.stubGlobal('navigator', { getGamepads: () => plugged });
});

afterEach(() => {
  end();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

describe('Pads', () => {
  it('takes the gamepad that is there', async () => {
    plugged = [null, gamepad(1, 'Pad (Vendor: 045e)')];
    await start();
    expect(pads.name).toBe('Pad');
    expect(pads.notice).toBe('');
  });

  it('goes on with another gamepad where the one in use goes', async () => {
    plugged = [gamepad(0, 'First'), gamepad(1, 'Second')];
    await start();
    expect(pads.name).toBe('First');
    plugged = [null, plugged[1] ?? null];
    page.dispatchEvent(new Event('gamepaddisconnected'));
    expect(pads.name).toBe('Second');
    expect(pads.notice).toContain('First disconnected');
  });

  it('does not take one that is listed though it has gone', async () => {
    plugged = [gamepad(0, 'First')];
    await start();
    plugged = [gamepad(0, 'First', false)];
    page.dispatchEvent(new Event('gamepaddisconnected'));
    expect(pads.name).toBeNull();
    expect(pads.notice).toContain('First disconnected');
  });

  it('says so where the browser offers no gamepads, as Firefox over http', async () => {
    vi.stubGlobal('navigator', {});
    await start();
    expect(pads.name).toBeNull();
    expect(pads.notice).toContain('https');
  });
});
