import { describe, expect, it } from 'vitest';
import type { TunableParameter } from '../src/generated/topics';
import { alarmVoltage, timeToAlarm } from '../src/live/battery';

/** A ring's columns: a voltage each second. */
function measured(volts: number[]) {
  const time = Float64Array.from(volts, (_, second) => 1000 + second);
  return [{ length: volts.length, time, place: (order: number) => order }, Float64Array.from(volts)] as const;
}

const falling = (seconds: number, from: number, slope: number) => Array.from({ length: seconds }, (_, at) => from + slope * at);

const tuned = (value: number) => [{ name: 'fins.gain', value: 0.625 }, { name: 'battery.alarm', value }] as TunableParameter[];

describe('alarmVoltage', () => {
  it('is the value in force', () => {
    expect(alarmVoltage(tuned(7))).toBe(7);
  });

  it('is the default until the values are known', () => {
    expect(alarmVoltage(null)).toBe(6.2);
    expect(alarmVoltage([])).toBe(6.2);
  });
});

describe('timeToAlarm', () => {
  it('tells when a falling voltage meets the alarm', () => {
    // From 7.2 V by 1 mV a second: at 7.0 V after 200 s, so 800 s more to 6.2 V.
    const volts = measured(falling(201, 7.2, -0.001));
    expect(timeToAlarm(...volts, 6.2)).toBeCloseTo(800, 3);
    expect(timeToAlarm(...volts, 6.9)).toBeCloseTo(100, 3);
  });

  it('sees through noise', () => {
    const noisy = falling(300, 7.2, -0.001).map((volts, at) => volts + (at % 2 === 0 ? 0.02 : -0.02));
    expect(timeToAlarm(...measured(noisy), 6.2)).toBeCloseTo(701, -2);
  });

  it('is over where the alarm is near or past', () => {
    expect(timeToAlarm(...measured(falling(100, 6.25, -0.001)), 6.2)).toBe(0);
  });

  it.each([
    ['nothing came', []],
    ['too little came', falling(30, 7.2, -0.001)],
  ])('says nothing where %s', (_, volts) => {
    expect(timeToAlarm(...measured(volts), 6.2)).toBeNull();
  });

  it.each([
    ['does not fall', falling(200, 7.2, 0)],
    ['rises', falling(200, 7.2, 0.001)],
  ])('is never over where the voltage %s', (_, volts) => {
    expect(timeToAlarm(...measured(volts), 6.2)).toBe(Infinity);
  });
});
