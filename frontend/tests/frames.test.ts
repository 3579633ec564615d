import { describe, expect, it } from 'vitest';
import type { LinkFrame } from '../src/api';
import { ANY, asText, INVALID, kindsIn, matching, messageWords, numberWords, since, sizeOf, spacedBytes } from '../src/pages/system/frames';

function frame(some: Partial<LinkFrame>): LinkFrame {
  return { time: 0, sent: false, bytes: '0102ff00', kinds: ['Imu'], reliable: false, open: false, number: 300, acknowledged: 2, problem: '', ...some };
}

const depth = frame({ time: 10, kinds: ['Imu', 'Depth'] });
const start = frame({ time: 10.5, sent: true, kinds: ['Start'], reliable: true, number: 3 });
const broken = frame({ time: 11.25, kinds: [], number: null, acknowledged: null, problem: 'wrong checksum' });
const all = [depth, start, broken];

describe('what a frame says', () => {
  it('names its messages, and counts several of a kind', () => {
    expect(messageWords(depth)).toBe('attitude, depth');
    expect(messageWords(frame({ kinds: ['Debug', 'Debug', 'Acknowledge'] }))).toBe('2 × debug text, acknowledgement');
    expect(messageWords(broken)).toBe('unreadable');
    expect(messageWords(frame({ kinds: ['Sonar'] }))).toBe('Sonar');
  });

  it('tells the two countings apart', () => {
    expect([depth, start, broken, frame({ open: true, number: 0 })].map(numberWords)).toEqual(['300', 'R 3', '', 'open']);
  });

  it('measures and spaces its bytes', () => {
    expect(sizeOf(depth)).toBe(4);
    expect(spacedBytes(depth)).toBe('01 02 ff 00');
  });

  it('counts time back from the newest in whole milliseconds', () => {
    expect(since(10, 11.25)).toBe('\u22121.250');
    expect(since(11.25, 11.25)).toBe('\u20070.000');
    expect(since(11.2496, 11.25)).toBe('\u20070.000');
  });
});

describe('matching', () => {
  it('goes by direction and kind together', () => {
    expect(matching(all, 'both', ANY)).toEqual(all);
    expect(matching(all, 'sent', ANY)).toEqual([start]);
    expect(matching(all, 'received', 'Depth')).toEqual([depth]);
    expect(matching(all, 'sent', 'Depth')).toEqual([]);
    expect(matching(all, 'both', INVALID)).toEqual([broken]);
  });

  it('offers the kinds that occur, in the order of their words', () => {
    expect(kindsIn(all)).toEqual(['Imu', 'Depth', 'Start']);
  });
});

it('writes a line for each frame', () => {
  expect(asText('The last', [start, broken], 11.25).split('\n')).toEqual([
    'The last',
    '-0.750 s\tto board\tstart\tnumber R 3\tawaits 2\t4 B\tvalid\t0102ff00',
    '0.000 s\tfrom board\tunreadable\t-\t-\t4 B\tINVALID: wrong checksum\t0102ff00',
    '',
  ]);
});
