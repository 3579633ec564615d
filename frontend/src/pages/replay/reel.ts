import { PICTURE_TOPICS, ROW_TOPICS } from '../../generated/topics';
import { readBlocks, readDocuments, type Block } from '../../live/blocks';
import type { Live } from '../../live/live.svelte';

const ROW_BYTES: ReadonlyMap<number, number> = new Map(
  Object.values(ROW_TOPICS).map((topic) => [topic.id, topic.rowBytes]),
);

/** What one topic has in store. */
interface Strip {
  add(block: Block): void;
  /** hand over what is earlier than `until` (s, steady clock) */
  unroll(until: number, live: Live): void;
}

class RowStrip implements Strip {
  #blocks: Block[] = [];
  /** bytes of the first block that were handed over */
  #at = 0;

  constructor(private readonly rowBytes: number) {}

  add(block: Block): void {
    this.#blocks.push(block);
  }

  unroll(until: number, live: Live): void {
    let done = 0;
    for (const block of this.#blocks) {
      const { payload } = block;
      let end = this.#at;
      while (end < payload.byteLength && payload.getFloat64(end, true) < until) end += this.rowBytes;
      if (end > this.#at) {
        live.take({ ...block, payload: new DataView(payload.buffer, payload.byteOffset + this.#at, end - this.#at) });
      }
      if (end < payload.byteLength) {
        this.#at = end;
        break;
      }
      this.#at = 0;
      done += 1;
    }
    this.#blocks.splice(0, done);
  }
}

class DocumentStrip implements Strip {
  #documents: { time: number }[] = [];

  constructor(private readonly topic: number) {}

  add(block: Block): void {
    this.#documents = this.#documents.concat(readDocuments(block) as { time: number }[]);
  }

  unroll(until: number, live: Live): void {
    const later = this.#documents.findIndex((document) => document.time >= until);
    const due = this.#documents.splice(0, later === -1 ? this.#documents.length : later);
    live.takeDocuments(this.topic, due);
  }
}

class PictureStrip implements Strip {
  #blocks: Block[] = [];

  add(block: Block): void {
    this.#blocks.push(block);
  }

  unroll(until: number, live: Live): void {
    const later = this.#blocks.findIndex(({ payload }) => payload.getFloat64(0, true) >= until);
    const due = this.#blocks.splice(0, later === -1 ? this.#blocks.length : later);
    const newest = due.at(-1);
    if (newest !== undefined) live.take(newest);
  }
}

/** Samples that were fetched and are not due yet, topic by topic. */
export class Reel {
  readonly #strips = new Map<number, Strip>();

  /** Put in blocks that are later than those of their topics that are here already. */
  add(buffer: ArrayBuffer): void {
    for (const block of readBlocks(buffer)) {
      let strip = this.#strips.get(block.topic);
      if (strip === undefined) {
        strip = makeStrip(block.topic);
        this.#strips.set(block.topic, strip);
      }
      strip.add(block);
    }
  }

  /** Hand over to `live` what is earlier than `until` (s, steady clock). */
  unroll(until: number, live: Live): void {
    for (const strip of this.#strips.values()) strip.unroll(until, live);
  }

  clear(): void {
    this.#strips.clear();
  }
}

function makeStrip(topic: number): Strip {
  const rowBytes = ROW_BYTES.get(topic);
  if (rowBytes !== undefined) return new RowStrip(rowBytes);
  return topic === PICTURE_TOPICS.picture ? new PictureStrip() : new DocumentStrip(topic);
}
