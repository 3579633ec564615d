import { describe, expect, it } from 'vitest';
import type { Signal, Spectrum } from '../src/api';
import { axisRange, drawPair, drawSpectra, readLimits, signalTitle, writeLimits } from '../src/pages/sessions/study/figure';

const signal = (topic: string, column: string, unit: string): Signal => ({ name: `${topic}.${column}`, topic, column, unit, meaning: '' });
const DEPTH = signal('depth', 'depth', 'm');
const OUTPUT = signal('control', 'output', '');
const RATE = signal('imu', 'rate_0', 'rad/s');
const token = (name: string) => name;
const spectrum = (one: Signal): Spectrum => ({ signal: one, frequency: [1, 2], density: [0.1, 0.01], peak: null, problem: '' }) as unknown as Spectrum;

describe('the ends of an axis in the address', () => {
  it('are read as they were written', () => {
    for (const limits of [
      { least: 0, most: 1.5 },
      { least: -2, most: null },
      { least: null, most: 1e-6 },
    ]) {
      expect(readLimits(writeLimits(limits) ?? '')).toEqual(limits);
    }
    expect(writeLimits({ least: null, most: null })).toBeNull();
  });

  it('are automatic where they are nonsense', () => {
    for (const nonsense of ['', ',', 'x,1', '1', '1,2,3', '1e999,2', 'NaN,1']) expect(readLimits(nonsense)).toEqual({ least: null, most: null });
  });
});

describe('the pictures of a study', () => {
  it('name a signal once where its topic has the same name', () => {
    expect([DEPTH, OUTPUT].map(signalTitle)).toEqual(['depth (m)', 'control, output']);
  });

  it('draw a depth downwards, with fixed ends too', () => {
    const pair = { x: OUTPUT, y: DEPTH, x_values: [0], y_values: [1], time: [0] };
    expect(drawPair(pair, token).downwards).toBe(true);
    expect(drawPair({ ...pair, x: DEPTH, y: OUTPUT }, token).downwards).toBe(false);
    expect(axisRange({ least: null, most: null }, false, true)).toEqual({ autorange: 'reversed' });
    expect(axisRange({ least: 0, most: 1 }, false, true)).toEqual({ autorange: false, range: [1, 0] });
    expect(axisRange({ least: 0, most: null }, false, true)).toEqual({ autorange: 'max reversed', range: [null, 0] });
  });

  it('name the unit of the density where the signals share one', () => {
    expect(drawSpectra([spectrum(DEPTH)], token).y).toBe('Density (m² / Hz)');
    expect(drawSpectra([spectrum(RATE)], token).y).toBe('Density ((rad/s)² / Hz)');
    expect(drawSpectra([spectrum(DEPTH), spectrum(OUTPUT)], token).y).toBe('Density (unit² / Hz)');
  });
});
