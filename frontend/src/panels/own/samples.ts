import type { Live } from '../../live/live.svelte';
import { ROW_TOPICS, type Detection, type Rows, type State } from '../../generated/topics';

type Topic = keyof Rows;

/** Data that one's own panel is given, ten times a second (docs/use/panels.md). Times are in s, steady clock of the robot. */
export interface Samples {
  readonly now: number;
  readonly replayed: boolean;
  /** rows of the topics that it asked for which came since the last time, oldest first */
  readonly rows: Partial<Record<Topic, readonly Rows[Topic][]>>;
  readonly state: State | null;
  readonly detection: Detection | null;
}

/** s that the first hand-over reaches back */
const PAST = 60;

export function knownTopics(asked: unknown): readonly Topic[] {
  if (!Array.isArray(asked)) return [];
  return (Object.keys(ROW_TOPICS) as Topic[]).filter((topic) => asked.includes(topic));
}

/** Hands out what came since the last time. */
export class Handing {
  readonly #until = new Map<Topic, number>();

  constructor(
    private readonly live: Live,
    private readonly topics: readonly Topic[],
  ) {}

  next(): Samples {
    const { now, replayed, state, documents } = this.live;
    const rows = Object.fromEntries(this.topics.map((topic) => [topic, this.#since(topic, now)]));
    return { now, replayed, rows, state, detection: documents.detection.value };
  }

  #since(topic: Topic, now: number): readonly Rows[Topic][] {
    // Before the robot's clock is known, nothing is handed out: the first hand-over is to have the last minute.
    if (Number.isNaN(now)) return [];
    const ring = this.live.rings[topic];
    const newest = ring.newest;
    const until = this.#until.get(topic) ?? now - PAST;
    // Another moment of a replay, or another start of the robot's computer: the past begins anew.
    const from = newest !== null && newest < until ? now - PAST : until;
    const found: Rows[Topic][] = [];
    for (let order = ring.firstSince(from); order < ring.length; order += 1) {
      const row = ring.row(order);
      if (row.time > from) found.push(row);
    }
    this.#until.set(topic, newest ?? from);
    return found;
  }
}
