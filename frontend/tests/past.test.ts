import { beforeEach, describe, expect, it, vi } from 'vitest';
import type { Answer } from '../src/api';
import { ROW_TOPICS } from '../src/generated/topics';
import { Past, type RowName } from '../src/live/past';
import { createRings, type Rings } from '../src/live/store';
import { blockBytes, join, rowBytes } from './bytes';

const depths = (...times: number[]) => join(...times.map((time) => rowBytes(ROW_TOPICS.depth, time)));
const asBlock = (...times: number[]) => blockBytes(ROW_TOPICS.depth.id, 0, times.length, 0, depths(...times));

let rings: Rings;
let asked: [readonly RowName[], number][];
let answers: Answer<ArrayBuffer>[];
let past: Past;

beforeEach(() => {
  vi.useFakeTimers();
  rings = createRings();
  asked = [];
  answers = [];
  past = new Past(
    rings,
    (topics, until) => {
      asked.push([topics, until]);
      return Promise.resolve(answers.shift() ?? { problem: 'none' });
    },
    () => undefined,
  );
  rings.depth.append(new DataView(depths(50, 51).buffer), -Infinity);
});

const times = () => Array.from({ length: rings.depth.length }, (_, order) => rings.depth.time[rings.depth.place(order)]);

describe('Past', () => {
  it('puts what the server had before what the ring has, without what both have', async () => {
    answers.push({ value: join(asBlock(10, 20), asBlock(40, 50, 51)).buffer });
    past.want('depth');
    past.want('depth');
    await vi.advanceTimersByTimeAsync(100);
    past.want('depth');
    await vi.advanceTimersByTimeAsync(100);
    expect(asked).toEqual([[['depth'], 50]]);
    expect(times()).toEqual([10, 20, 40, 50, 51]);
  });

  it('asks for nothing while the present is not known', async () => {
    past.want('imu');
    await vi.advanceTimersByTimeAsync(100);
    expect(asked).toEqual([]);
  });

  it('asks again after a while where there was no answer', async () => {
    past.want('depth');
    await vi.advanceTimersByTimeAsync(100);
    past.want('depth');
    await vi.advanceTimersByTimeAsync(100);
    expect(asked).toHaveLength(1);
    await vi.advanceTimersByTimeAsync(5000);
    past.want('depth');
    await vi.advanceTimersByTimeAsync(100);
    expect(asked).toHaveLength(2);
  });

  it('does not believe an answer to a question from before the rings began anew', async () => {
    answers.push({ value: join(asBlock(10, 20)).buffer });
    past.want('depth');
    vi.advanceTimersByTime(30);
    past.forget();
    rings.depth.clear();
    await vi.advanceTimersByTimeAsync(100);
    expect(times()).toEqual([]);
  });
});
