import type { Answer } from '../api';
import type { Rows } from '../generated/topics';
import { readBlocks } from './blocks';
import type { Rings } from './store';

export type RowName = keyof Rows;

const TOGETHER = 20;
const RETRY = 5000;

/**
 * Fetches what charts show of the time before the page was opened; the server keeps it, and each topic is asked for
 * once.
 */
export class Past {
  readonly #asked = new Set<RowName>();
  #wanted = new Set<RowName>();
  /** counts what made earlier answers useless */
  #turn = 0;

  /** @param fetch all rows of these topics up to a time (s, steady clock), as blocks */
  constructor(
    private readonly rings: Rings,
    private readonly fetch: (topics: readonly RowName[], until: number) => Promise<Answer<ArrayBuffer>>,
    private readonly taken: () => void,
  ) {}

  /** Somebody looks at this topic before its ring begins. */
  readonly want = (topic: RowName): void => {
    if (this.#asked.has(topic) || this.rings[topic].oldest === null) return;
    this.#asked.add(topic);
    if (this.#wanted.size === 0) setTimeout(() => void this.#ask(), TOGETHER);
    this.#wanted.add(topic);
  };

  /** The rings begin anew. */
  forget(): void {
    this.#turn += 1;
    this.#asked.clear();
    this.#wanted.clear();
  }

  async #ask(): Promise<void> {
    const topics = [...this.#wanted];
    const turn = this.#turn;
    this.#wanted = new Set();
    if (topics.length === 0) return;
    const answer = await this.fetch(topics, Math.max(...topics.map((topic) => this.rings[topic].oldest ?? 0)));
    if (turn !== this.#turn) return;
    if ('problem' in answer) {
      setTimeout(() => topics.forEach((topic) => this.#asked.delete(topic)), RETRY);
      return;
    }
    // A ring takes what is older than all that it has: the newest block first.
    for (const block of readBlocks(answer.value).reverse()) {
      topics.map((topic) => this.rings[topic]).find((ring) => ring.topic.id === block.topic)?.prepend(block.payload);
    }
    this.taken();
  }
}
