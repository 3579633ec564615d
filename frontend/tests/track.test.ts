import { expect, test } from 'vitest';
import { ROW_TOPICS } from '../src/generated/topics';
import { RowRing } from '../src/live/ring';
import { boxOf, wayOf } from '../src/parts/mission/track';

/** A ring with a row each second: 1 m on along heading 0 each time. */
function ring(rows: number): RowRing<'track'> {
  const made = new RowRing(ROW_TOPICS.track, 1000);
  const view = new DataView(new ArrayBuffer(rows * ROW_TOPICS.track.rowBytes));
  for (let row = 0; row < rows; row += 1) {
    const at = row * ROW_TOPICS.track.rowBytes;
    view.setFloat64(at, row, true);
    [row, 0, 0.1 * row, 0.05 * row].forEach((value, index) => view.setFloat32(at + 8 + 4 * index, value, true));
  }
  made.append(view, -Infinity);
  return made;
}

test('the way is that of the mission alone, with the deviation of its end', () => {
  const way = wayOf(ring(10), 2, 6);
  expect(way?.points).toEqual([[2, 0], [3, 0], [4, 0], [5, 0]]);
  expect(way?.deviation[0]).toBeCloseTo(0.5);
  expect(way?.deviation[1]).toBeCloseTo(0.25);
});

test('before the first row there is no way', () => {
  expect(wayOf(ring(0), 0, 10)).toBeNull();
  expect(wayOf(ring(10), 20, 30)).toBeNull();
});

test('of a long way so many points are drawn as are seen, and its end', () => {
  const way = wayOf(ring(900), 0, 1000);
  expect(way?.points.length).toBeLessThanOrEqual(301);
  expect(way?.points.at(-1)).toEqual([899, 0]);
});

test('the drawing has start, way and error, heading 0 upwards, in whole lines of the grid', () => {
  const [left, top, wide, high] = boxOf({ points: [[0, 0], [2, 1]], deviation: [0.5, 0.25] });
  expect([left, top, left + wide, top + high]).toEqual([-1, -4, 2, 1]);
});
