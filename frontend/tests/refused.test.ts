/** Abilities that a browser lacks or refuses: each is said in a sentence or left out, and nothing fails. */
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { capOf, readLetters } from '../src/drive/keyCaps';
import { vibrate } from '../src/drive/vibration';
import { keepAwake } from '../src/flight/awake';
import { FullScreen } from '../src/flight/fullScreen.svelte';
import { SoundPlayer } from '../src/sound/player';

const refuse = () => Promise.reject(new DOMException('no', 'NotAllowedError'));
const fail = () => {
  throw new DOMException('no', 'SecurityError');
};
const ALARM = [{ kind: 'alarm', words: 'Alarm. Water in the hull.' }] as const;

/** Put these in the place of the browser's own until the test ends. */
function browser(abilities: Record<string, unknown>): void {
  for (const [name, ability] of Object.entries(abilities)) vi.stubGlobal(name, ability);
}

beforeEach(() => {
  const document = Object.assign(new EventTarget(), { visibilityState: 'visible', fullscreenElement: null });
  browser({ document, navigator: {}, isSecureContext: true });
});
afterEach(() => {
  vi.unstubAllGlobals();
});

describe('a screen that stays on', () => {
  async function reason(): Promise<string> {
    const said: string[] = [];
    const end = keepAwake((reason) => said.push(reason));
    await vi.waitFor(() => {
      expect(said).toHaveLength(1);
    });
    end();
    expect(said.at(-1)).toBe('');
    return said[0] ?? '';
  }

  it('says that the browser cannot', async () => {
    expect(await reason()).toContain('this browser cannot keep it on');
  });

  it('says that it needs https', async () => {
    browser({ isSecureContext: false });
    expect(await reason()).toContain('https');
  });

  it('says that the browser refused', async () => {
    browser({ navigator: { wakeLock: { request: refuse } } });
    expect(await reason()).toContain('the browser refused to keep it on');
  });
});

describe('a full screen', () => {
  it.each([
    { fullscreenEnabled: false, problem: 'This browser has no full screen for pages.' },
    { fullscreenEnabled: true, problem: 'The browser refused the full screen.' },
  ])('says: $problem', async ({ fullscreenEnabled, problem }) => {
    Object.assign(document, { fullscreenEnabled, documentElement: { requestFullscreen: refuse } });
    const escaped = vi.fn();
    const screen = new FullScreen(escaped);
    const end = screen.start();
    await screen.toggle();
    end();
    expect(screen.problem).toBe(problem);
    expect(screen.on).toBe(false);
    expect(escaped).not.toHaveBeenCalled();
  });
});

describe('speech and a phone’s vibration', () => {
  class Audio {
    readonly state = 'running';
    readonly close = () => Promise.resolve();
  }

  it('says that the browser does not speak', async () => {
    browser({ AudioContext: Audio });
    const player = new SoundPlayer();
    await player.wake();
    expect(player.problem(true)).toBe('This browser has no voice.');
    expect(player.problem(false)).toBe('');
  });

  it('goes on where the browser refuses to speak', () => {
    browser({ speechSynthesis: { cancel: fail, speak: fail }, SpeechSynthesisUtterance: vi.fn() });
    expect(() => {
      new SoundPlayer().play(ALARM, 'full', true);
    }).not.toThrow();
  });

  it('speaks where the browser refuses to vibrate', () => {
    const speak = vi.fn();
    browser({ navigator: { vibrate: fail }, speechSynthesis: { cancel: vi.fn(), speak }, SpeechSynthesisUtterance: vi.fn() });
    new SoundPlayer().play(ALARM, 'full', true);
    expect(speak).toHaveBeenCalledOnce();
  });
});

describe('a gamepad’s vibration', () => {
  it.each([undefined, null, {}, { playEffect: refuse }, { playEffect: fail }])('stays still with %o', async (vibrationActuator) => {
    const unhandled = vi.fn();
    process.on('unhandledRejection', unhandled);
    vibrate({ vibrationActuator } as unknown as Gamepad, 'alarm');
    await new Promise(setImmediate);
    process.off('unhandledRejection', unhandled);
    expect(unhandled).not.toHaveBeenCalled();
  });
});

describe('letters of this keyboard', () => {
  it.each([{}, { keyboard: { getLayoutMap: refuse } }, { keyboard: { getLayoutMap: fail } }])('are those of a US keyboard with %o', async (navigator) => {
    browser({ navigator });
    expect(capOf(await readLetters(), 'KeyQ', 'Q')).toBe('Q');
  });
});
