import { flight as texts } from '../texts/flight';

/** Keys that a page may keep for itself in full screen; Chromium alone has it. */
interface KeyLock {
  lock(codes: readonly string[]): Promise<void>;
  unlock(): void;
}

/**
 * The whole screen for the page.
 *
 * A browser takes Esc for itself there, and tells the page nothing of it: an end that this page did not ask for counts
 * as Esc, which is STOP, unless the browser leaves Esc to the page.
 */
export class FullScreen {
  on = $state(document.fullscreenElement !== null);
  problem = $state('');
  #asked = false;
  #ownsEscape = false;

  /** @param escaped called where it ended without being asked for here */
  constructor(private readonly escaped: () => void) {}

  /** Follow the browser. Returns what ends it, the full screen too. */
  readonly start = (): (() => void) => {
    document.addEventListener('fullscreenchange', this.#follow);
    return () => {
      document.removeEventListener('fullscreenchange', this.#follow);
      this.#leave();
    };
  };

  readonly toggle = async (): Promise<void> => {
    this.problem = '';
    if (this.on) {
      this.#leave();
      return;
    }
    // Missing on an iPhone, whatever the types say.
    if (!document.fullscreenEnabled) {
      this.problem = texts.fullScreenNone;
      return;
    }
    try {
      await document.documentElement.requestFullscreen();
    } catch {
      this.problem = texts.fullScreenDenied;
      return;
    }
    this.#ownsEscape = (await this.#keys?.lock(['Escape']).then(() => true, () => false)) ?? false;
  };

  get #keys(): KeyLock | undefined {
    return (navigator as { keyboard?: KeyLock }).keyboard;
  }

  #leave(): void {
    if (document.fullscreenElement === null) return;
    this.#asked = true;
    void document.exitFullscreen();
  }

  readonly #follow = (): void => {
    this.on = document.fullscreenElement !== null;
    if (this.on) return;
    if (!this.#asked && !this.#ownsEscape) this.escaped();
    if (this.#ownsEscape) this.#keys?.unlock();
    this.#asked = this.#ownsEscape = false;
  };
}
