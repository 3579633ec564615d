/** Which of the robot's events are heard: each once, and none that was so before the page came. */
import type { Alarm } from '../generated/topics';
import type { Mission } from '../generated/topics';
import { sound as texts } from '../texts/sound';

/** Kinds of sounds; where several events come at once, the tone of the first of these is played. */
export const KINDS = ['alarm', 'battery', 'lost', 'mission', 'armed', 'disarmed'] as const;
export type SoundKind = (typeof KINDS)[number];

export interface SoundEvent {
  readonly kind: SoundKind;
  readonly words: string;
}

/** What of the robot is listened to. Null where it is not known. */
export interface Heard {
  readonly armed: boolean | null;
  readonly alarms: readonly Pick<Alarm, 'fault' | 'severity' | 'active' | 'since' | 'what'>[];
  /** of the page with the server, and of the server with the board */
  readonly linked: boolean | null;
  readonly mission: Pick<Mission, 'number' | 'phase' | 'title'> | null;
}

/** s within which the same is not heard again: an alarm that comes and goes is one */
const AGAIN_AFTER = 30;
const BATTERY = 'battery_low';
const UNDER_WAY: readonly Mission['phase'][] = ['running', 'paused'];

const isUnderWay = (mission: Heard['mission']) => mission !== null && UNDER_WAY.includes(mission.phase);

/** Compares each state with the one before. */
export class SoundEvents {
  #armed: boolean | null = null;
  #linked: boolean | null = null;
  #mission: Heard['mission'] = null;
  /** the alarms known, by fault and beginning; null before the first state */
  #alarms: ReadonlySet<string> | null = null;
  /** s, when each was heard last */
  readonly #heard = new Map<string, number>();

  /** The sounds of a new state, most urgent first; `now` in s of any steady clock. */
  take(state: Heard, now: number): SoundEvent[] {
    const events = [...this.#newAlarms(state, now), ...this.#changes(state, now)];
    this.#armed = state.armed ?? this.#armed;
    this.#linked = state.linked ?? this.#linked;
    this.#mission = state.mission ?? this.#mission;
    return events.sort((one, other) => KINDS.indexOf(one.kind) - KINDS.indexOf(other.kind));
  }

  #changes({ armed, linked, mission }: Heard, now: number): SoundEvent[] {
    const events: SoundEvent[] = [];
    if (this.#armed !== null && armed !== null && armed !== this.#armed) {
      const kind = armed ? 'armed' : 'disarmed';
      events.push({ kind, words: texts.words[kind] });
    }
    if (this.#linked === true && linked === false && this.#isNew('lost', now)) events.push({ kind: 'lost', words: texts.words.lost });
    const ended = mission !== null && !isUnderWay(mission) && isUnderWay(this.#mission) && mission.number === this.#mission?.number;
    if (ended) events.push({ kind: 'mission', words: texts.words.mission(mission.title, mission.phase) });
    return events;
  }

  #newAlarms({ alarms, armed }: Heard, now: number): SoundEvent[] {
    // Before the robot's first state nobody knows which alarms are old.
    if (armed === null) return [];
    const known = this.#alarms;
    const grave = alarms.filter(({ active, severity }) => active && severity === 'alarm');
    const name = ({ fault, since }: Heard['alarms'][number]) => `${fault} ${since}`;
    this.#alarms = new Set(grave.map(name));
    if (known === null) return [];
    return grave
      .filter((alarm) => !known.has(name(alarm)) && this.#isNew(alarm.fault, now))
      .map(({ fault, what }) => (fault === BATTERY ? { kind: 'battery', words: texts.words.battery } : { kind: 'alarm', words: texts.words.alarm(what) }));
  }

  /** Note that something is heard now; false where it was a short time ago. */
  #isNew(name: string, now: number): boolean {
    const last = this.#heard.get(name) ?? -Infinity;
    this.#heard.set(name, now);
    return now - last >= AGAIN_AFTER;
  }
}
