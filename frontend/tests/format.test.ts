import { afterEach, describe, expect, it, vi } from 'vitest';
import { age, baud, bytes, count, dateTime, duration, fixed, heading, inZone, MISSING, zonedDateTime, zoneOffset } from '../src/format';

describe('fixed', () => {
  it('keeps its decimals and writes a true minus', () => {
    expect(fixed(1.005, 2)).toBe('1.00');
    expect(fixed(-0.5, 2)).toBe('\u22120.50');
  });

  it('has no minus before zero', () => {
    expect(fixed(-0.001, 2)).toBe('0.00');
  });

  it('is as wide with a sign as without', () => {
    expect(fixed(0.5, 2, 'space')).toHaveLength(fixed(-0.5, 2, 'space').length);
  });

  it.each([null, undefined, NaN, Infinity])('says that %s is missing', (value) => {
    expect(fixed(value, 1)).toBe(MISSING);
  });
});

describe('heading', () => {
  const radians = (degrees: number) => (degrees * Math.PI) / 180;
  it.each([
    [0, '000'],
    [84.4, '084'],
    [-1, '359'],
    [359.7, '000'],
    [-359.7, '000'],
    [180, '180'],
  ])('writes %f° as %s', (degrees, text) => {
    expect(heading(radians(degrees))).toBe(text);
  });
});

it('writes durations', () => {
  expect(duration(134)).toBe('02:14');
  expect(duration(3734.9)).toBe('1:02:14');
  expect(duration(-3)).toBe('00:00');
});

it('writes ages', () => {
  expect([3.21, 14.9, 150, 7300].map(age)).toEqual(['3.2 s', '14 s', '2 min', '2 h']);
});

it('writes counts and sizes', () => {
  expect(count(1234567)).toBe('1\u202f234\u202f567');
  expect([999, 1500, 2_340_000, 5e9].map(bytes)).toEqual(['999 B', '1.5 kB', '2.3 MB', '5.00 GB']);
  expect([250_000, 9600, 115_200].map(baud)).toEqual(['250k', '9600', '115200']);
});

describe('local times', () => {
  afterEach(() => vi.restoreAllMocks());

  it.each([
    [-120, 'UTC+2'],
    [-345, 'UTC+5:45'],
    [210, 'UTC\u22123:30'],
    [0, 'UTC'],
  ])('name their zone, %i min from UTC', (minutes, offset) => {
    vi.spyOn(Date.prototype, 'getTimezoneOffset').mockReturnValue(minutes);
    expect(zoneOffset(new Date())).toBe(offset);
    expect(zonedDateTime('2026-01-15T12:00:00Z')).toBe(`${dateTime('2026-01-15T12:00:00Z')} ${offset}`);
  });

  it('name the zone of a whole list in its heading', () => {
    const options = new Intl.DateTimeFormat().resolvedOptions();
    vi.spyOn(Intl.DateTimeFormat.prototype, 'resolvedOptions').mockReturnValue({ ...options, timeZone: 'Europe/Tallinn' });
    expect(inZone('Started')).toBe('Started, Europe/Tallinn');
  });
});
