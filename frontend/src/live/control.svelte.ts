import { connection } from '../texts/connection';
import type { ControlState } from '../api';
import type { You } from './messages';

const texts = connection.barred;

/**
 * The control lease as this page sees it: one page or program at a time has control.
 *
 * A page whose user may have it takes control that is free by itself when it connects and is seen, so that somebody
 * who is alone with the robot never hears of it. What was given up on purpose is not taken back.
 */
export class Control {
  /** who this page is to the robot; null until it is connected */
  you = $state.raw<You | null>(null);
  /** null until the robot has said who has the control */
  now = $state.raw<ControlState | null>(null);
  /** what went wrong with the last thing that was asked */
  problem = $state('');
  /** who took control over from this page, until it is closed or this page has control again */
  lostTo = $state<string | null>(null);
  #eager = true;
  #released = false;

  /** @param takes whether this page may take control by itself now: somebody can see it */
  constructor(
    private readonly call: ControlCalls,
    private readonly takes: () => boolean,
  ) {}

  /** whether this page has the control */
  get mine(): boolean {
    return this.you !== null && this.now?.holder?.client === this.you.client;
  }

  /** Why this page cannot command the robot, in words; null where it can. STOP always can. */
  get barred(): string | null {
    if (this.you === null || this.now === null) return texts.unknown;
    if (this.you.role === 'viewer') return texts.viewer;
    if (this.mine) return null;
    if (this.now.holder === null) return texts.nobody;
    return texts.other(this.now.holder.name);
  }

  greet(you: You): void {
    this.you = you;
    this.#eager = !this.#released;
  }

  hear(message: ControlState): void {
    if (this.mine && message.holder !== null && message.holder.client !== this.you?.client) this.lostTo = message.holder.name;
    this.now = message;
    if (this.mine) this.lostTo = null;
    // What this browser has held by another page comes free when that is closed: after a reload, for one.
    if (message.holder !== null && message.holder.name !== this.you?.name) this.#eager = false;
    this.consider();
  }

  /** The connection is gone, and control with it. */
  leave(): void {
    this.you = null;
    this.now = null;
  }

  /** Take what is free, where that is for this page to do by itself. */
  readonly consider = (): void => {
    if (!this.#eager || this.you?.role !== 'operator' || this.now?.holder !== null || !this.takes()) return;
    this.#eager = false;
    void this.take();
  };

  /** Take control that is free. */
  readonly take = (): Promise<void> => this.#claim(this.call.take());
  /** Take control from whoever has it. */
  readonly takeOver = (): Promise<void> => this.#claim(this.call.takeOver());
  readonly forgetLoss = (): void => {
    this.lostTo = null;
  };

  readonly release = (): Promise<void> => {
    this.#released = true;
    this.#eager = false;
    return this.#run(this.call.release());
  };

  /** A page that asks for control means to have it again after a break of the connection. */
  #claim(asked: Promise<string | null>): Promise<void> {
    this.#released = false;
    return this.#run(asked);
  }

  async #run(asked: Promise<string | null>): Promise<void> {
    this.problem = (await asked) ?? '';
  }
}

/** Requests about control; each answers what went wrong, or null. */
interface ControlCalls {
  take(): Promise<string | null>;
  release(): Promise<string | null>;
  takeOver(): Promise<string | null>;
}
