import { describe, expect, it } from 'vitest';
import type { SessionDetail } from '../src/api';
import { alike, findTooLong, orderProblem, SHEET_LINES } from '../src/pages/sessions/export/formats';
import { asked, frames, pictured } from '../src/pages/sessions/film';
import { depthPath } from '../src/pages/sessions/depthPath';
import { narrows, NO_FILTERS, queryOf, readFilters, withTags, writeFilters } from '../src/pages/sessions/find';
import { compareLink, replayLink } from '../src/pages/sessions/links';
import { heightOf, rowAt, rowsBetween } from '../src/pages/sessions/placing';
import { gapWords } from '../src/pages/sessions/words';

describe('tags', () => {
  it('are added once, whatever their letters', () => {
    expect(withTags(['pool'], ' Pool, sea ,, sea')).toEqual(['pool', 'sea']);
  });
});

describe('film', () => {
  const topic = (count: number, first: number, last: number, name = 'thumbnail') => ({ name, count, first, last }) as SessionDetail['topics'][number];

  it('gives small pictures where there are no others and it can be read', () => {
    const [small, film] = [topic(1, 1, 2), topic(9, 1, 9, 'film')];
    expect(pictured([film, small], true)).toBe(small);
    expect(pictured([film], true)).toBe(film);
    expect(pictured([film], false)).toBeUndefined();
  });

  it('spreads over the session, and never asks beyond its end', () => {
    expect(frames(undefined)).toEqual([]);
    expect(frames(topic(1, 3, 3))).toEqual([3]);
    expect(frames(topic(3, 1, 5))).toEqual([1, 3, 5]);
    const long = frames(topic(1800, 1.23456, 3600.98765));
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

describe('a long list', () => {
  const groups = [
    { name: 'a', count: 2 },
    { name: 'b', count: 3 },
  ];
  const heights = { row: 10, heading: 4 };

  it('draws the rows in view, a heading with the first of its group', () => {
    expect(heightOf(groups, heights)).toBe(58);
    expect(rowsBetween(groups, heights, 0, 58).map(({ index, top, height, group }) => [index, top, height, group?.name])).toEqual([
      [0, 0, 14, 'a'],
      [1, 14, 10, undefined],
      [2, 24, 14, 'b'],
      [3, 38, 10, undefined],
      [4, 48, 10, undefined],
    ]);
    expect(rowsBetween(groups, heights, 15, 23).map(({ index }) => index)).toEqual([1]);
    // The heading alone is in view.
    expect(rowsBetween(groups, heights, 25, 26).map(({ index }) => index)).toEqual([2]);
    expect(rowsBetween(groups, heights, 1000, 2000)).toEqual([]);
    expect(rowsBetween([], heights, 0, 10)).toEqual([]);
  });

  it('finds a row wherever it stands', () => {
    for (const row of rowsBetween(groups, heights, 0, 58)) expect(rowAt(groups, heights, row.index)).toEqual(row);
    expect(rowAt(groups, heights, 5)).toBeNull();
    expect(rowsBetween([{ name: '', count: 10_000 }], { row: 88, heading: 0 }, 440_000, 440_900).map(({ index }) => index)).toEqual(
      [5000, 5001, 5002, 5003, 5004, 5005, 5006, 5007, 5008, 5009, 5010],
    );
  });
});

describe('filters in the address', () => {
  const filters = { ...NO_FILTERS, search: ' deep ', tags: ['pool', 'sea'], origin: 'arming', film: true, since: '2026-05-30', until: '2026-05-31', by: 'day' } as const;

  it('come back as they were', () => {
    const written = Object.entries(writeFilters(filters)).flatMap(([name, value]) => (value === null ? [] : [[name, value] as const]));
    expect(readFilters(new Map(written))).toEqual(filters);
    expect(Object.values(writeFilters(NO_FILTERS)).every((value) => value === null)).toBe(true);
    expect([narrows(NO_FILTERS), narrows({ ...NO_FILTERS, by: 'day', search: ' ' }), narrows(filters)]).toEqual([false, false, true]);
  });

  it('are whole local days for the server', () => {
    const { since, until, search, tag, kept } = queryOf(filters);
    expect([since, until]).toEqual([new Date(2026, 4, 30).toISOString(), new Date(2026, 5, 1).toISOString()]);
    expect([search, tag, kept]).toEqual(['deep', ['pool', 'sea'], undefined]);
  });

  it('that are nonsense count as none', () => {
    const seen = new Map(Object.entries({ origin: '<b>', film: 'yes', since: '2026-02-31', until: 'x', by: 'constructor', tag: ',,' }));
    expect(readFilters(seen)).toEqual(NO_FILTERS);
    expect(readFilters(new Map([['search', 'x'.repeat(1_000_000)]])).search).toHaveLength(200);
  });
});

describe('a small curve', () => {
  it('has the surface on top, and leaves out what nobody measured', () => {
    expect(depthPath([])).toBeNull();
    expect(depthPath([null, null])).toBeNull();
    expect(depthPath([0, null, 1])).toEqual({ line: 'M0.0 2.0L100.0 38.0', area: 'M0.0 2.0L100.0 38.0L100.0 2L0.0 2Z' });
    // A robot that floats draws no mountains.
    expect(depthPath([0.003, -0.01])?.line).toBe('M0.0 2.4L100.0 2.0');
  });
});
