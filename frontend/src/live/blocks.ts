/** Blocks as they come through the socket; docs/reference/live-socket.md and robot_runtime/contract/topics.py say how they lie. */

export const Kind = { ROWS: 0, DOCUMENTS: 1, PICTURE: 2 } as const;

const HEADER_BYTES = 12;

export interface Block {
  readonly topic: number;
  readonly kind: number;
  readonly count: number;
  /** Number of the block's first sample since its writer started. */
  readonly first: number;
  readonly payload: DataView<ArrayBuffer>;
}

/** Bytes that are not whole blocks. */
export class BlockError extends Error {}

/** The blocks in `buffer`, one after the other, as views on it. */
export function readBlocks(buffer: ArrayBuffer): Block[] {
  const blocks: Block[] = [];
  let at = 0;
  while (at < buffer.byteLength) {
    const left = buffer.byteLength - at;
    if (left < HEADER_BYTES) throw new BlockError(`a block's header is cut off after ${left} bytes`);
    const header = new DataView(buffer, at, HEADER_BYTES);
    const bytes = header.getUint32(8, true);
    if (left - HEADER_BYTES < bytes) {
      throw new BlockError(`a block is cut off: ${left - HEADER_BYTES} of ${bytes} bytes`);
    }
    blocks.push({
      topic: header.getUint8(0),
      kind: header.getUint8(1),
      count: header.getUint16(2, true),
      first: header.getUint32(4, true),
      payload: new DataView(buffer, at + HEADER_BYTES, bytes),
    });
    at += HEADER_BYTES + bytes;
  }
  return blocks;
}

/** The objects in the payload of a block of documents. */
export function readDocuments(block: Block): unknown[] {
  const parsed: unknown = JSON.parse(new TextDecoder().decode(block.payload));
  if (!Array.isArray(parsed)) throw new BlockError('a block of documents holds no list');
  return parsed;
}

/** The time of the picture in the payload (s, steady clock) and its JPEG file. */
export function readPicture(block: Block): { time: number; jpeg: Blob } {
  const { payload } = block;
  if (payload.byteLength <= 8) throw new BlockError(`a picture of ${payload.byteLength} bytes`);
  const file = new Uint8Array(payload.buffer, payload.byteOffset + 8, payload.byteLength - 8);
  return { time: payload.getFloat64(0, true), jpeg: new Blob([file], { type: 'image/jpeg' }) };
}
