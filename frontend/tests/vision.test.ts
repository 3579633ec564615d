import { describe, expect, it } from 'vitest';
import type { ColourRange, VisionSettings } from '../src/api';
import { css, freeName, hueSpan, middle, nameProblem, renamed, without } from '../src/pages/tune/vision/colours';

const RED: ColourRange = { hue: [170, 10], saturation: [255, 255], value: [255, 255] };
const GREEN: ColourRange = { hue: [55, 65], saturation: [255, 255], value: [255, 255] };
const SETTINGS = { colour: 'red', colours: { red: RED, green: GREEN }, actions: { green: 2, 'marker 7': 1 } } as unknown as VisionSettings;

describe('colours as OpenCV counts them', () => {
  it('are drawn as they look', () => {
    expect(css(60, 255, 255)).toBe('hsl(120 100.0% 50.0%)');
    expect(css(0, 0, 255)).toBe('hsl(0 0.0% 100.0%)');
    expect(css(90, 128, 0)).toBe('hsl(180 0.0% 0.0%)');
  });

  it('run through 0', () => {
    expect(hueSpan(RED)).toBe(20);
    expect(middle(RED)).toBe('hsl(0 100.0% 50.0%)');
  });
});

describe('named colours', () => {
  it('are renamed wherever they are named, in their place', () => {
    const now = renamed(SETTINGS, 'green', 'buoy');
    expect(Object.keys(now.colours ?? {})).toEqual(['red', 'buoy']);
    expect(now.actions).toEqual({ buoy: 2, 'marker 7': 1 });
    expect(now.colour).toBe('red');
    expect(renamed(SETTINGS, 'red', 'ball').colour).toBe('ball');
  });

  it('take their action with them', () => {
    expect(without(SETTINGS, 'green')).toEqual({ colours: { red: RED }, actions: { 'marker 7': 1 } });
  });

  it('have names that tell them apart', () => {
    expect(freeName({ 'colour 1': RED, 'colour 3': RED })).toBe('colour 2');
    expect(nameProblem('Boje grün', SETTINGS.colours)).toBe('');
    expect(nameProblem('red', SETTINGS.colours)).not.toBe('');
    expect(nameProblem('red', SETTINGS.colours, 'red')).toBe('');
    for (const name of ['', '7', 'marker 7', 'a'.repeat(33)]) expect(nameProblem(name, {})).not.toBe('');
  });
});
