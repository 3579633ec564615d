import { describe, expect, it } from 'vitest';
import { ROW_TOPICS, type Rows } from '../src/generated/topics';
import { BlockError } from '../src/live/blocks';
import { RowRing } from '../src/live/ring';
import { createRings } from '../src/live/store';
import { join, rowBytes } from './bytes';

const topic = ROW_TOPICS.depth;
const rows = (...times: number[]) =>
  new DataView(join(...times.map((time) => rowBytes(topic, time, { depth: [time * 100] }))).buffer);

function orderOf(ring: RowRing<'depth'>): number[] {
  return Array.from({ length: ring.length }, (_, order) => ring.time[ring.place(order)] ?? NaN);
}

describe('the rings', () => {
  it.each([
    ['control', 50],
    ['turning', 50],
    ['navigation', 70],
    ['truth', 20],
    ['imu', 100],
  ] as const)('hold ten minutes of %s at its highest rate, and not much more', (name, rate) => {
    const { capacity } = createRings()[name];
    expect(capacity).toBeGreaterThanOrEqual(600 * rate);
    expect(capacity).toBeLessThan(650 * rate);
  });
});

describe('RowRing', () => {
  it.each(Object.keys(ROW_TOPICS) as (keyof Rows)[])('reads every field of %s where the runtime wrote it', (name) => {
    const layout = ROW_TOPICS[name];
    const counts: Record<string, number[]> = {};
    let next = 1;
    for (const field of layout.fields) counts[field.name] = Array.from({ length: field.count }, () => next++);
    const ring = new RowRing(layout, 4);
    ring.append(new DataView(join(rowBytes(layout, 3.25, counts)).buffer), -Infinity);
    const read = ring.latest() as unknown as Record<string, number | number[]>;
    expect(read.time).toBe(3.25);
    for (const { name: field, scale } of layout.fields) {
      const expected = (counts[field] ?? []).map((count) => count * scale);
      const found = [read[field] ?? NaN].flat();
      expect(found).toHaveLength(expected.length);
      found.forEach((value, element) => expect(value).toBeCloseTo(expected[element] ?? NaN, 6));
    }
  });

  it('keeps whole numbers that a float of four bytes would round', () => {
    const ring = new RowRing(topic, 2);
    ring.append(new DataView(join(rowBytes(topic, 1, { board_time: [4294967295] })).buffer), -Infinity);
    expect(ring.latest()?.board_time).toBe(4294967295);
  });

  it('lets the oldest rows go', () => {
    const ring = new RowRing(topic, 3);
    ring.append(rows(1, 2), -Infinity);
    ring.append(rows(3, 4, 5), -Infinity);
    expect(orderOf(ring)).toEqual([3, 4, 5]);
    expect(ring.newest).toBe(5);
    expect(ring.latest()?.depth).toBeCloseTo(0.5, 6);
  });

  it('skips what is known already', () => {
    const ring = new RowRing(topic, 8);
    ring.append(rows(1, 2, 3), -Infinity);
    expect(ring.append(rows(2, 3, 4), 3)).toBe(1);
    expect(orderOf(ring)).toEqual([1, 2, 3, 4]);
  });

  it('finds the first row since a time, also after it wrapped', () => {
    const ring = new RowRing(topic, 4);
    ring.append(rows(1, 2, 3, 4, 5, 6), -Infinity);
    expect(ring.firstSince(0)).toBe(0);
    expect(ring.firstSince(4.5)).toBe(2);
    expect(ring.firstSince(5)).toBe(2);
    expect(ring.firstSince(7)).toBe(4);
  });

  it('refuses bytes that are no whole rows', () => {
    expect(() => new RowRing(topic, 4).append(new DataView(new ArrayBuffer(topic.rowBytes + 1)), 0)).toThrow(BlockError);
  });
});
