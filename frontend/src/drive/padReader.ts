import type { Axis, Push } from './axes';
import { deflection, downOf, pushesOf, type Button, type PadProfile } from './gamepad';

/** A gamepad of `navigator.getGamepads()`. */
export type SeenPad = Pick<Gamepad, 'id' | 'index' | 'connected' | 'mapping' | 'axes' | 'buttons' | 'timestamp'>;
export type PadList = readonly (SeenPad | null | undefined)[];

/** s without anything new from a gamepad that holds something, until the page says so, and until it lets go */
export const SILENT_NOTICE = 2;
export const SILENT_RELEASE = 5;

/** An axis that is out of its rest, though nothing may count yet. */
export interface OffRest {
  readonly axis: Axis;
  readonly value: number;
}

/** One look at all gamepads. */
export interface PadLook {
  /** the one that drives; null while there is none */
  readonly pad: SeenPad | null;
  readonly profile: PadProfile | null;
  /** what counts now */
  readonly pushes: readonly Push[];
  /** buttons that went down since the last look */
  readonly pressed: readonly Button[];
  /** whether everything has to be released before it counts */
  readonly waits: boolean;
  readonly offRest: readonly OffRest[];
  /** s without anything new while something is held; 0 while nothing is */
  readonly silence: number;
  /** has appeared since the last look */
  readonly joined: boolean;
  /** the id of the one that drove and is gone since the last look */
  readonly gone: string | null;
  /** has sticks, but nobody has assigned them */
  readonly unassigned: SeenPad | null;
}

interface Memory {
  readonly id: string;
  down: readonly Button[];
  /** whether everything has rested since it may count */
  rested: boolean;
  /** all that it sends */
  sent: string;
  /** s; when that was new */
  since: number;
}

interface Candidate {
  readonly pad: SeenPad;
  readonly profile: PadProfile;
  readonly memory: Memory;
  readonly pushes: readonly Push[];
  readonly pressed: readonly Button[];
}

/** Name of a gamepad among those that are there: two of the same kind are told apart by their order. */
export function padKey(pad: SeenPad, list: PadList): string {
  const alike = list.filter((one) => one?.connected === true && one.id === pad.id);
  return `${pad.id}#${alike.findIndex((one) => one?.index === pad.index)}`;
}

/**
 * Tells which gamepad drives, and what of it counts.
 *
 * The one that is moved drives, unless one is chosen. Each has to be seen at rest before it counts.
 */
export class PadReader {
  readonly #memories = new Map<number, Memory>();
  #current: number | null = null;

  /**
   * @param profileOf assignments of a gamepad; null where there are none
   * @param choice the key of the one that shall drive; null: the one that is moved
   */
  constructor(
    private readonly profileOf: (pad: SeenPad) => PadProfile | null,
    private readonly choice: () => string | null,
  ) {}

  /**
   * @param at s, of a clock that never runs back
   * @param steers whether what is held would move the robot
   */
  look(list: PadList, at: number, steers: boolean): PadLook {
    const there = list.filter((pad): pad is SeenPad => pad?.connected === true);
    const before = this.#current === null ? undefined : this.#memories.get(this.#current);
    for (const [index, { id }] of this.#memories) {
      if (!there.some((pad) => pad.index === index && pad.id === id)) this.#memories.delete(index);
    }
    const known = this.#memories.size;
    const candidates = there.flatMap((pad) => this.#read(pad, at, steers));
    const lost = before !== undefined && this.#memories.get(this.#current ?? -1) !== before;
    if (lost) this.#current = null;
    const current = this.#choose(candidates, list);
    this.#current = current?.pad.index ?? null;
    const waits = current !== null && current.pushes.length > 0 && !current.memory.rested;
    return {
      pad: current?.pad ?? null,
      profile: current?.profile ?? null,
      pushes: current === null || waits ? [] : current.pushes,
      pressed: current?.pressed ?? [],
      waits,
      offRest: current === null || !waits ? [] : offRest(current),
      silence: current === null || current.pushes.length === 0 ? 0 : at - current.memory.since,
      joined: this.#memories.size > known,
      gone: lost ? before.id : null,
      unassigned: there.find((pad) => pad.axes.length >= 2 && this.profileOf(pad) === null) ?? null,
    };
  }

  #read(pad: SeenPad, at: number, steers: boolean): Candidate[] {
    const profile = this.profileOf(pad);
    if (profile === null) return [];
    const pushes = pushesOf(pad, profile);
    const down = downOf(pad, profile);
    // A browser renews the time stamp with what the system reports; where it does not, a hand's trembling shows in the axes.
    const sent = [pad.timestamp, ...pad.axes, ...pad.buttons.map(({ value, pressed }) => `${value}${pressed}`)].join();
    const memory = this.#memories.get(pad.index) ?? { id: pad.id, down, rested: false, sent, since: at };
    const pressed = down.filter((name) => !memory.down.includes(name));
    if (memory.sent !== sent) memory.since = at;
    memory.sent = sent;
    memory.down = down;
    if (pushes.length === 0) memory.rested = true;
    // Nobody meant what was held before it counted, nor what nothing tells of any more.
    else if (!steers || at - memory.since >= SILENT_RELEASE) memory.rested = false;
    this.#memories.set(pad.index, memory);
    return [{ pad, profile, memory, pushes, pressed }];
  }

  #choose(candidates: readonly Candidate[], list: PadList): Candidate | null {
    const choice = this.choice();
    const chosen = candidates.find(({ pad }) => padKey(pad, list) === choice);
    if (chosen !== undefined) return chosen;
    const current = candidates.find(({ pad }) => pad.index === this.#current);
    const moves = ({ pushes, memory }: Candidate) => pushes.length > 0 && memory.rested;
    if (current !== undefined && moves(current)) return current;
    const moved = candidates.find((one) => one !== current && (moves(one) || one.pressed.length > 0));
    return moved ?? current ?? candidates[0] ?? null;
  }
}

/** Axes of the robot that the gamepad's own axes push. */
function offRest({ pad, profile }: Candidate): OffRest[] {
  return profile.motions.flatMap(({ stick }, axis) => {
    const value = stick === null ? 0 : deflection(pad, stick);
    return stick !== null && Math.abs(value) > stick.dead ? [{ axis: axis as Axis, value }] : [];
  });
}
