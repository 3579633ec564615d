import type { ControlMessage, You } from './messages';

/**
 * Who has the control of the robot: one page or program at a time.
 *
 * A page whose user may have it takes control that is free by itself when it connects and is seen, so that somebody
 * who is alone with the robot never hears of it. What was given up on purpose is not taken back.
 */
export class Control {
  /** who this page is to the robot; null until it is connected */
  you = $state.raw<You | null>(null);
  /** null until the robot has said who has the control */
  now = $state.raw<ControlMessage | null>(null);
  /** what went wrong with the last thing that was asked */
  problem = $state('');
  #eager = true;
  #released = false;

  /** @param seen whether somebody can see this page now */
  constructor(
    private readonly call: ControlCalls,
    private readonly seen: () => boolean,
  ) {}

  /** whether this page has the control */
  get mine(): boolean {
    return this.you !== null && this.now?.holder?.seat === this.you.seat;
  }

  /** whether this page has asked for the control and waits */
  get asked(): boolean {
    return this.you !== null && this.now?.request?.seat === this.you.seat;
  }

  /** whether this page has just been refused */
  get refused(): boolean {
    return this.you !== null && this.now?.refused?.seat === this.you.seat;
  }

  /** Why this page cannot command the robot, in words; null where it can. STOP always can. */
  get barred(): string | null {
    if (this.you === null || this.now === null) return 'It is not known yet who has control.';
    if (this.you.role === 'viewer') return 'Viewers may watch and STOP.';
    if (this.mine) return null;
    if (this.now.holder === null) return 'Nobody has control: take it first.';
    return `Control is with ${this.now.holder.name}: ask for it first.`;
  }

  greet(you: You): void {
    this.you = you;
    this.#eager = !this.#released;
  }

  hear(message: ControlMessage): void {
    this.now = message;
    // What this browser has held by another page comes free when that is closed: after a reload, for one.
    if (message.holder !== null && message.holder.name !== this.you?.name) this.#eager = false;
    this.consider();
  }

  /** The connection is gone, and the seat with it. */
  leave(): void {
    this.you = null;
    this.now = null;
  }

  /** Take what is free, where that is for this page to do by itself. */
  readonly consider = (): void => {
    if (!this.#eager || this.you?.role !== 'operator' || this.now?.holder !== null || !this.seen()) return;
    this.#eager = false;
    void this.take();
  };

  /** Take control, or ask for it where somebody has it. */
  readonly take = (): Promise<void> => this.#run(this.call.take());
  readonly refuse = (): Promise<void> => this.#run(this.call.refuse());
  readonly handOver = (seat: number): Promise<void> => this.#run(this.call.handOver(seat));

  readonly release = (): Promise<void> => {
    this.#released = true;
    this.#eager = false;
    return this.#run(this.call.release());
  };

  async #run(asked: Promise<string | null>): Promise<void> {
    this.problem = (await asked) ?? '';
  }
}

/** What can be asked about control; each answers what went wrong, or null. */
export interface ControlCalls {
  take(): Promise<string | null>;
  release(): Promise<string | null>;
  refuse(): Promise<string | null>;
  handOver(seat: number): Promise<string | null>;
}
