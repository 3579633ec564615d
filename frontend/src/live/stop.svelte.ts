import { api } from '../api';

const RETRY_EVERY = 250;
const CONFIRMED_SHOWN = 2000;

type StopState = 'idle' | 'sending' | 'confirmed';

/**
 * STOP, sent by every way there is and again until the server says that it was taken.
 *
 * The socket is the quicker way and HTTP the one that answers, so both are used. `end` ends it all: a STOP that waits
 * for a server must not stop the robot by surprise when this browser has access again.
 */
export class Stop {
  state = $state<StopState>('idle');
  /** counts the presses of this page: what is held ends with each */
  presses = $state(0);
  attempts = $state(0);
  problem = $state('');
  #rest: ReturnType<typeof setTimeout> | undefined;
  #ended = false;

  /** @param byHttp answers why it was not taken; null where it was */
  constructor(
    private readonly bySocket: () => boolean,
    private readonly byHttp: () => Promise<string | null> = api.stop,
  ) {}

  readonly press = (): void => {
    this.bySocket();
    this.presses += 1;
    if (this.state === 'sending') return;
    clearTimeout(this.#rest);
    this.state = 'sending';
    this.attempts = 0;
    void this.#insist();
  };

  readonly end = (): void => {
    this.#ended = true;
  };

  async #insist(): Promise<void> {
    for (;;) {
      this.attempts += 1;
      const refusal = await this.byHttp();
      if (refusal === null) break;
      this.problem = refusal;
      await new Promise((resolve) => setTimeout(resolve, RETRY_EVERY));
      if (this.#ended) return;
      this.bySocket();
    }
    this.problem = '';
    this.state = 'confirmed';
    this.#rest = setTimeout(() => {
      this.state = 'idle';
    }, CONFIRMED_SHOWN);
  }
}
