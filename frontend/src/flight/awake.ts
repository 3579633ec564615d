import { flight } from '../texts/flight';

const texts = flight.dark;

/**
 * Keep the screen on while this page is seen. Returns what ends it.
 *
 * @param say called with the reason why it may go dark; empty where it stays on
 */
export function keepAwake(say: (reason: string) => void): () => void {
  // Missing where the page came without TLS, and in old browsers, whatever the types say.
  const lock = (navigator as { wakeLock?: WakeLock }).wakeLock;
  if (lock === undefined) {
    say(isSecureContext ? texts.none : texts.insecure);
    return () => say('');
  }
  let held: WakeLockSentinel | null = null;
  let over = false;

  // The browser takes it back with each hidden tab.
  const take = () => void request();

  async function request() {
    if (document.visibilityState !== 'visible') return;
    try {
      const taken = await lock?.request('screen');
      if (over) void taken?.release();
      else held = taken ?? null;
      if (!over) say('');
    } catch {
      if (!over) say(texts.denied);
    }
  }

  document.addEventListener('visibilitychange', take);
  take();
  return () => {
    over = true;
    document.removeEventListener('visibilitychange', take);
    void held?.release();
    say('');
  };
}
