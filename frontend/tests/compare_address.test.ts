import { describe, expect, it } from 'vitest';
import { MOST_SIGNALS, readAlign, readFigures, readSegments, readSignals, readView, rounded, writeAlign, writeFigures, writeSegments } from '../src/pages/sessions/compare/seen';

const START = { by: 'start', number: 1, marker: '', step: '' };

describe('the address of a comparison', () => {
  it('names signals, each once and no more than a chart takes', () => {
    expect(readSignals('depth.depth,imu.roll,depth.depth')).toEqual(['depth.depth', 'imu.roll']);
    for (const none of ['', ',,,', 'x'.repeat(101)]) expect(readSignals(none)).toEqual([]);
    expect(readSignals(Array.from({ length: 10_000 }, (_, place) => `s${place}`).join(','))).toHaveLength(MOST_SIGNALS);
  });

  it('names what begins together, and reads what it has written', () => {
    for (const align of [
      { ...START, by: 'armed' },
      { ...START, by: 'segment' },
      { ...START, by: 'set_point', number: 3 },
      { ...START, by: 'marker', marker: 'card: yellow, 2' },
      { ...START, by: 'marker' },
      { ...START, by: 'mission', step: 'root/2' },
    ] as const) {
      expect(readAlign(writeAlign(align as Parameters<typeof writeAlign>[0]) ?? '')).toEqual(align);
    }
    expect(writeAlign(START as Parameters<typeof writeAlign>[0])).toBeNull();
  });

  it('begins at the start where the alignment is nonsense', () => {
    for (const text of ['', 'nonsense', 'set_point', 'set_point:0', 'set_point:1.5', 'set_point:1e9', 'set_point:NaN', `marker:${'x'.repeat(101)}`, 'constructor']) {
      expect(readAlign(text)).toEqual(START);
    }
  });

  it('names the part of the time that the figures cover', () => {
    expect(readFigures(writeFigures({ start: -1.23456, end: 30 }))).toEqual({ start: -1.235, end: 30 });
    for (const none of ['', '5', '5,', ',5', '5,1', '1,2,3', 'a,b', '1,1e999', ' , ']) expect(readFigures(none)).toBeNull();
  });

  it('shows all of the time where the range is none', () => {
    expect(readView(90, 20)).toBeNull();
    expect(readView(5, 5)).toBeNull();
    expect(readView(null, 20)).toBeNull();
    expect(readView(-1.5, 20)).toEqual({ start: -1.5, end: 20 });
    expect(rounded({ start: 1.23456, end: 2 })).toEqual({ start: 1.235, end: 2 });
  });

  it('names a segment of each session, and passes over what is none', () => {
    const choices = [
      { session: 7, segment: 2 },
      { session: 9, segment: 1 },
    ];
    expect(readSegments('9:1,7:2,8:3', [7, 9])).toEqual(choices);
    expect(readSegments(writeSegments(choices), [7, 9])).toEqual(choices);
    expect(readSegments('7:2', [7, 9])).toEqual([choices[0]]);
    for (const none of ['', 'like', '7', '7:', '7:0', '7:1.5', '7:201', '7:x', ':2', '7:NaN', '7:Infinity']) expect(readSegments(none, [7, 9])).toEqual([]);
    expect(writeSegments([])).toBe('like');
  });
});
