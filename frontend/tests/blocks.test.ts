import { describe, expect, it } from 'vitest';
import { ROW_TOPICS } from '../src/generated/topics';
import { BlockError, readBlocks, readDocuments, readPicture } from '../src/live/blocks';
import { blockBytes, depthBlock, documentBlock, join } from './bytes';

describe('readBlocks', () => {
  it('finds every block of a message', () => {
    const message = join(depthBlock(1, [0.1, 0.2], 7), documentBlock(18, [{ time: 1 }], 3));
    const [depth, debug] = readBlocks(message.buffer);
    expect(depth).toMatchObject({ topic: ROW_TOPICS.depth.id, kind: 0, count: 2, first: 7 });
    expect(depth?.payload.byteLength).toBe(2 * ROW_TOPICS.depth.rowBytes);
    expect(debug).toMatchObject({ topic: 18, kind: 1, count: 1, first: 3 });
  });

  it('takes an empty message for no blocks', () => {
    expect(readBlocks(new ArrayBuffer(0))).toEqual([]);
  });

  it.each([1, 11, 12, 20])('refuses a message that ends %i bytes too early', (missing) => {
    const message = depthBlock(1, [0.1]);
    const cut = join(message.subarray(0, message.length - missing));
    expect(() => readBlocks(cut.buffer)).toThrow(BlockError);
  });
});

describe('payloads', () => {
  it('reads documents', () => {
    const [block] = readBlocks(join(documentBlock(18, [{ text: 'µ' }, { text: 'é' }])).buffer);
    expect(block && readDocuments(block)).toEqual([{ text: 'µ' }, { text: 'é' }]);
  });

  it('refuses documents that are no list', () => {
    const payload = new TextEncoder().encode('{"text":"alone"}');
    const [block] = readBlocks(join(blockBytes(18, 1, 1, 0, payload)).buffer);
    expect(() => block && readDocuments(block)).toThrow(BlockError);
  });

  it('reads a picture and its time', async () => {
    const payload = new Uint8Array(11);
    new DataView(payload.buffer).setFloat64(0, 12.5, true);
    payload.set([0xff, 0xd8, 0xff], 8);
    const [block] = readBlocks(join(blockBytes(32, 2, 1, 0, payload)).buffer);
    const picture = block && readPicture(block);
    expect(picture?.time).toBe(12.5);
    expect(new Uint8Array(await (picture?.jpeg ?? new Blob()).arrayBuffer())).toEqual(new Uint8Array([0xff, 0xd8, 0xff]));
  });

  it('refuses a picture without a file', () => {
    const [block] = readBlocks(join(blockBytes(32, 2, 1, 0, new Uint8Array(8))).buffer);
    expect(() => block && readPicture(block)).toThrow(BlockError);
  });
});
