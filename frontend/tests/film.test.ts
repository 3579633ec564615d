import { afterEach, describe, expect, it, vi } from 'vitest';
import type { Answer, FilmDescription, FilmPart } from '../src/api';
import { nextPart, Screening } from '../src/film/screening';
import { filmedMoment, isFilmed } from '../src/film/spans';
import { NO_ANSWER } from '../src/http';

const WHOLE = [{ start: 1, end: 100 }];

describe('the next part of a film', () => {
  it('brings the picture where the film stands, even the last of its span', () => {
    const spans = [
      { start: 1, end: 10 },
      { start: 20, end: 30 },
    ];
    expect([10, 9.9, 30].map((at) => nextPart(at, [], spans)?.start)).toEqual([10, 9.9, 30]);
    expect(nextPart(30, [{ start: 29, end: 30.07 }], spans)).toBeNull();
  });

  it('begins short where the film stands, so that it comes soon', () => {
    expect(nextPart(20, [], WHOLE)).toEqual({ start: 20, seconds: 1 });
  });

  it('follows what is stored, in longer parts', () => {
    expect(nextPart(20, [{ start: 19.5, end: 22.05 }], WHOLE)).toEqual({ start: 22.05, seconds: 10 });
  });

  it('follows parts that hardly touch', () => {
    expect(nextPart(20, [{ start: 19, end: 22 }, { start: 22.1, end: 32 }], WHOLE)).toEqual({ start: 32, seconds: 10 });
  });

  it('ends where a part is in store, whose later pictures build on its first ones', () => {
    expect(nextPart(20, [{ start: 19, end: 22 }, { start: 25, end: 30 }], WHOLE)).toEqual({ start: 22, seconds: 3 });
    expect(nextPart(20, [{ start: 20.6, end: 30 }], WHOLE)?.seconds).toBeCloseTo(0.6);
  });

  it('is none while enough is in store, and at the end of the film', () => {
    expect(nextPart(20, [{ start: 19, end: 36 }], WHOLE)).toBeNull();
    expect(nextPart(99, [{ start: 90, end: 99.9 }], WHOLE)).toBeNull();
  });

  it('begins with the first picture of a film that begins later', () => {
    expect(nextPart(0, [], WHOLE)).toEqual({ start: 1, seconds: 1 });
  });

  it('comes before a pause of the film ends', () => {
    const spans = [{ start: 0, end: 10 }, { start: 20, end: 30 }];
    expect(nextPart(8, [{ start: 0, end: 10.06 }], spans)).toEqual({ start: 20, seconds: 10 });
    expect(nextPart(2, [{ start: 0, end: 10.06 }], spans)).toBeNull();
  });

  it('is none without a film', () => {
    expect(nextPart(0, [], [])).toBeNull();
  });
});

describe('a film that stands', () => {
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  it('asks again for a part that a busy server did not bring, and not for one that it refused', async () => {
    vi.useFakeTimers();
    const buffer = Object.assign(new EventTarget(), { updating: false, buffered: { length: 0 }, timestampOffset: 0, appendBuffer: vi.fn() });
    class Source extends EventTarget {
      duration = 0;
      addSourceBuffer = () => buffer;
      constructor() {
        super();
        queueMicrotask(() => this.dispatchEvent(new Event('sourceopen')));
      }
    }
    vi.stubGlobal('MediaSource', Source);
    vi.stubGlobal('URL', { createObjectURL: () => 'blob:film' });
    const answers: Answer<FilmPart>[] = [{ problem: 'No answer.', kind: NO_ANSWER }, { problem: 'Removed.', kind: '' }];
    const ask = vi.fn(() => Promise.resolve(answers.shift() ?? { problem: 'asked too often' }));
    const said: string[] = [];
    const video = Object.assign(new EventTarget(), { currentTime: 1 }) as HTMLVideoElement;
    new Screening(video, { codec: 'avc1', spans: WHOLE } as unknown as FilmDescription, ask, (problem) => said.push(problem));
    await vi.advanceTimersByTimeAsync(10_000);
    expect(said).toEqual(['No answer.', 'Removed.']);
  });
});

describe('moments of a film', () => {
  const spans = [{ start: 5, end: 10 }, { start: 20, end: 30 }];

  it('are the next ones that were filmed', () => {
    expect([0, 7, 15, 25, 40].map((at) => filmedMoment(at, spans))).toEqual([5, 7, 20, 25, 30]);
    expect(filmedMoment(3, [])).toBe(3);
  });

  it('are shown a little before and after it, too', () => {
    expect([3.9, 4.1, 10.9, 12, 19.5].map((at) => isFilmed(at, spans))).toEqual([false, true, true, false, true]);
  });
});
