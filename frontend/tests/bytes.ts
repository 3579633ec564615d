/** Blocks written by hand, as the runtime writes them. */
import { ROW_TOPICS, type Code, type RowTopic } from '../src/generated/topics';

const WRITERS: Record<Code, (view: DataView, at: number, value: number) => void> = {
  b: (view, at, value) => view.setInt8(at, value),
  B: (view, at, value) => view.setUint8(at, value),
  h: (view, at, value) => view.setInt16(at, value, true),
  H: (view, at, value) => view.setUint16(at, value, true),
  i: (view, at, value) => view.setInt32(at, value, true),
  I: (view, at, value) => view.setUint32(at, value, true),
  f: (view, at, value) => view.setFloat32(at, value, true),
  d: (view, at, value) => view.setFloat64(at, value, true),
};
const SIZES: Record<Code, number> = { b: 1, B: 1, h: 2, H: 2, i: 4, I: 4, f: 4, d: 8 };

/** One row whose fields hold these counts, before scaling; what is left out is 0. */
export function rowBytes(topic: RowTopic, time: number, counts: Record<string, number[]> = {}): Uint8Array {
  const row = new Uint8Array(topic.rowBytes);
  const view = new DataView(row.buffer);
  view.setFloat64(0, time, true);
  for (const field of topic.fields) {
    counts[field.name]?.forEach((count, element) => {
      WRITERS[field.code](view, field.offset + element * SIZES[field.code], count);
    });
  }
  return row;
}

export function blockBytes(topic: number, kind: number, count: number, first: number, payload: Uint8Array): Uint8Array {
  const block = new Uint8Array(12 + payload.length);
  const view = new DataView(block.buffer);
  view.setUint8(0, topic);
  view.setUint8(1, kind);
  view.setUint16(2, count, true);
  view.setUint32(4, first, true);
  view.setUint32(8, payload.length, true);
  block.set(payload, 12);
  return block;
}

export function join(...parts: Uint8Array[]): Uint8Array<ArrayBuffer> {
  const all = new Uint8Array(parts.reduce((size, part) => size + part.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}

/** A block of depths in m, 20 ms apart from `start` s on. */
export function depthBlock(start: number, depths: readonly number[], first = 0): Uint8Array {
  const rows = depths.map((depth, index) =>
    rowBytes(ROW_TOPICS.depth, start + 0.02 * index, { depth: [Math.round(depth * 1000)] }),
  );
  return blockBytes(ROW_TOPICS.depth.id, 0, rows.length, first, join(...rows));
}

export function documentBlock(topic: number, documents: readonly object[], first = 0): Uint8Array {
  return blockBytes(topic, 1, documents.length, first, new TextEncoder().encode(JSON.stringify(documents)));
}
