import { describe, expect, it } from 'vitest';
import { asText, lostSince, matching } from '../src/panels/console/console';
import { Lines } from '../src/live/lines.svelte';

const lines = [
  { time: 1, level: 0, text: 'loop 1840 us' },
  { time: 2, level: 2, text: 'Battery low' },
  { time: 3, level: 3, text: 'battery gone' },
];

describe('matching', () => {
  it('goes by level and text together', () => {
    expect(matching(lines, 0, '')).toBe(lines);
    expect(matching(lines, 2, '').map(({ time }) => time)).toEqual([2, 3]);
    expect(matching(lines, 0, ' BATTERY ').map(({ time }) => time)).toEqual([2, 3]);
    expect(matching(lines, 3, 'low')).toEqual([]);
    const foreign = [{ time: 4, level: 1, text: 'ÖÕÄÜ Straße' }];
    for (const word of ['öõäü', 'o\u0308o\u0303', 'ooau', 'STRASSE']) expect(matching(foreign, 0, word)).toEqual(foreign);
  });
});

it('counts lost lines from the last clearing, and from a reset of the board', () => {
  expect(lostSince(0, 4)).toBe(4);
  expect(lostSince(4, 4)).toBe(0);
  expect(lostSince(4, 6)).toBe(2);
  expect(lostSince(4, 1)).toBe(1);
});

it('copies lines with time and level', () => {
  expect(asText(lines.slice(1, 2), (time) => new Date(time * 1000))).toBe('1970-01-01T00:00:02.000Z warning Battery low');
});

describe('Lines', () => {
  it('keeps the newest and counts what it discarded', () => {
    const kept = new Lines<number>(3);
    kept.append([1, 2]);
    kept.append([3, 4, 5]);
    expect(kept.entries).toEqual([3, 4, 5]);
    expect(kept.discarded).toBe(2);
    expect(kept.added).toBe(5);
  });

  it('is empty after being cleared, and goes on counting', () => {
    const kept = new Lines<number>(3);
    kept.append([1]);
    kept.clear();
    kept.append([2]);
    expect(kept.entries).toEqual([2]);
    expect(kept.added).toBe(2);
  });
});
