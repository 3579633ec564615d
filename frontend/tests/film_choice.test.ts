import { expect, test } from 'vitest';
import type { FilmPlan } from '../src/api';
import { rates, space } from '../src/parts/recording/film';

const PLAN: FilmPlan = {
  record: true,
  rate: 15,
  quality: 'medium',
  rate_max: 15,
  coding: 'h264',
  refusal: '',
  picture_bytes: { low: 1000, medium: 2000, high: 20_000 },
  measured: false,
  room: 1.8e6 * 90,
};

test('the space of a film is that of its quality and rate', () => {
  expect(space(PLAN)).toBe('About 1.8 MB a minute; the disk has room for 90 min.');
  expect(space({ ...PLAN, rate: 5 })).toBe('About 0.6 MB a minute; the disk has room for 4 h.');
  expect(space({ ...PLAN, quality: 'high' })).toBe('About 18 MB a minute; the disk has room for 9 min.');
  expect(space({ ...PLAN, room: 30e9 })).toBe('About 1.8 MB a minute; the disk has room for 11 days.');
  expect(space({ ...PLAN, room: 0 })).toBe('About 1.8 MB a minute; the disk has room for 0 min.');
});

test('rates to choose from are those of the stream and the one in force', () => {
  expect(rates(PLAN)).toEqual([5, 10, 15]);
  expect(rates({ ...PLAN, rate_max: 12, rate: 8 })).toEqual([5, 8, 10, 12]);
});
