import { describe, expect, it } from 'vitest';
import type { SessionDetail } from '../src/api';
import { alike, findTooLong, orderProblem, SHEET_LINES } from '../src/pages/sessions/export/formats';
import { asked, frames } from '../src/pages/sessions/film';
import { withTags } from '../src/pages/sessions/find';
import { compareLink, replayLink } from '../src/pages/sessions/links';
import { gapWords } from '../src/pages/sessions/words';

describe('tags', () => {
  it('are added once, whatever their letters', () => {
    expect(withTags(['pool'], ' Pool, sea ,, sea')).toEqual(['pool', 'sea']);
  });
});

describe('film', () => {
  const topics = (count: number, first: number, last: number) =>
    [{ name: 'thumbnail', count, first, last }] as SessionDetail['topics'];

  it('spreads over the session, and never asks beyond its end', () => {
    expect(frames([])).toEqual([]);
    expect(frames(topics(1, 3, 3))).toEqual([3]);
    expect(frames(topics(3, 1, 5))).toEqual([1, 3, 5]);
    const long = frames(topics(1800, 1.23456, 3600.98765));
    expect(long).toHaveLength(24);
    expect(asked(long.at(-1) ?? Infinity)).toBeLessThanOrEqual(3600.98765);
  });
});

describe('words and addresses', () => {
  it('says what is missing', () => {
    const gap = { topic: 'imu', kind: 'missed', time: 1, missed: 1 } as const;
    expect(gapWords(gap)).toBe('1 sample of imu never arrived');
    expect(gapWords({ ...gap, kind: 'not stored', missed: 2 })).toContain('2 samples of imu not stored');
  });

  it('links to a moment', () => {
    expect(replayLink(7)).toBe('#/replay/7');
    expect(replayLink(7, 12.34)).toBe('#/replay/7?at=12.3');
    expect(replayLink(7, -0.2)).toBe('#/replay/7?at=0.0');
    expect(compareLink([7, 9])).toBe('#/sessions/compare/7,9');
  });
});

describe('an export', () => {
  it('that ends before it starts is refused in words', () => {
    expect(orderProblem(5, 2)).toBe('The end, 2 s, must be after the start, 5 s.');
    expect([orderProblem(5, null), orderProblem(null, 2), orderProblem(2, 5)]).toEqual(['', '', '']);
  });

  it('is like another one whose file would be the same', () => {
    expect(alike({ format: 'csv', start: null }, { format: 'csv', compression: 'none', period: 0.1 })).toBe(true);
    expect(alike({ format: 'csv', start: 1 }, { format: 'csv' })).toBe(false);
    expect(alike({ format: 'csv-grid', period: 0.2 }, { format: 'csv-grid' })).toBe(false);
    expect(alike({ format: 'mp4', overlay: 'lines' }, { format: 'mp4' })).toBe(false);
    expect(alike({ format: 'csv', spreadsheet: 'comma' }, { format: 'csv' })).toBe(false);
  });
});

describe('findTooLong', () => {
  const imu = { name: 'imu', lines: 2 * SHEET_LINES };
  it('names the longest table that a sheet does not hold', () => {
    expect(findTooLong([{ name: 'depth', lines: SHEET_LINES }, imu], 100, null, null)?.name).toBe('imu');
    expect(findTooLong([{ name: 'depth', lines: SHEET_LINES - 1 }], 100, null, null)).toBeNull();
    expect(findTooLong([], 100, null, null)).toBeNull();
  });

  it('counts the share that is in the range', () => {
    expect(findTooLong([imu], 100, 50.1, null)).toBeNull();
    expect(findTooLong([imu], 100, -10, 40)).toBeNull();
    expect(findTooLong([imu], 100, 20, 1000)).toEqual({ name: 'imu', lines: Math.ceil(2 * SHEET_LINES * 0.8) + 1 });
  });
});
