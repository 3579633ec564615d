import { describe, expect, it } from 'vitest';
import type { Compared, Comparison, Signal } from '../src/api';
import { bestOf } from '../src/parts/figures';
import { chartsOf, gather, PRESETS } from '../src/pages/sessions/compare/charts';
import { drawPicture, points, wholeView, type Look } from '../src/pages/sessions/compare/figure';
import { readIds } from '../src/pages/sessions/compare/links';

const LOOK: Look = { text: '#1', muted: '#2', panel: '#3', line: '#4', band: '#5', font: 'f', colours: ['blue', 'orange'] };
const UNITS: Record<string, string> = { 'depth.depth': 'm', 'control.set_point': 'm', 'control.error': 'm' };

function signal(name: string): Signal {
  const [topic = '', column = ''] = name.split('.');
  return { name, topic, column, unit: UNITS[name] ?? '', meaning: '' };
}

function session(id: number, offset: number | null, names: readonly string[]): Compared {
  const line = { time: [0, 1, 2], low: [0, 0.1, null], high: [0, 0.4, null] };
  return {
    id,
    offset,
    problem: offset === null ? 'never' : '',
    name: `session ${id}`,
    started: 0,
    duration: 10,
    state: 'complete',
    armed: [[2, 8]],
    mission_steps: [],
    set_point_steps: 0,
    events: [],
    markers: [{ time: 3, kind: 'marker', severity: 'info', text: 'here' }],
    segments: [],
    segment: null,
    range: [],
    figures: {},
    series: Object.fromEntries(names.map((name) => [name, line])),
  };
}

function comparison(names: readonly string[], sessions: Compared[]): Comparison {
  const align = { by: 'armed', number: 1, marker: '', step: '' } as const;
  return { align, signals: names.map(signal), sessions, figures: [], likeness: { alike: true, why: '' }, differences: [] };
}

describe('charts', () => {
  it('stacks what the thesis shows: depth with its set point, error, command, detection', () => {
    const charts = chartsOf((PRESETS[1]?.signals ?? []).map(signal));
    expect(charts.map(({ title }) => title)).toEqual([
      'Depth',
      'Depth error',
      'Heave command',
      'Detected colour, share of the picture',
    ]);
    expect(charts[0]?.signals.map(({ wanted }) => wanted)).toEqual([false, true]);
    expect(charts.map(({ downwards }) => downwards)).toEqual([true, false, false, false]);
  });

  it('puts the wanted angle of a fin beside the measured one', () => {
    const charts = chartsOf((PRESETS[2]?.signals ?? []).map(signal));
    expect(charts.map(({ title, signals }) => [title, signals.length])).toEqual([
      ['Fin, front right', 2],
      ['Fin, back right', 2],
      ['Fin, back left', 2],
      ['Fin, front left', 2],
    ]);
  });

  it('knows how many of the sessions have a signal', () => {
    const gathered = gather([[signal('depth.depth')], [signal('depth.depth'), signal('imu.rate_0')]]);
    expect(gathered.map(({ topic, choices }) => [topic, choices.map(({ name, note }) => [name, note])])).toEqual([
      ['depth', [['depth.depth', undefined]]],
      ['imu', [['imu.rate_0', 'in 1 of 2 sessions']]],
    ]);
  });
});

describe('lines', () => {
  it('run through the least and the most of each column, on the common axis, and break where nothing came', () => {
    expect(points({ time: [5, 6, 7], low: [0, 1, null], high: [0, 3, null] }, 5)).toEqual({
      x: [0, 1, 1, 2],
      y: [0, 1, 3, null],
    });
  });
});

describe('picture', () => {
  const names = ['depth.depth', 'control.set_point', 'control.error'];

  it('draws what can be aligned, in colours of their places, and the depth downwards', () => {
    const whole = comparison(names, [session(7, null, names), session(9, 2, ['depth.depth'])]);
    const { data, layout } = drawPicture(whole, new Map(), wholeView(whole), 1000, LOOK);
    expect(wholeView(whole)).toEqual({ start: -2, end: 8 });
    const [depth, told] = data as { x: number[]; line?: { color: string }; text?: string[] }[];
    expect(data).toHaveLength(2);
    expect([depth?.line?.color, depth?.x[0]]).toEqual(['orange', -2]);
    expect([told?.text, told?.x]).toEqual([['here'], [1]]);
    expect(layout.yaxis?.autorange).toBe('reversed');
  });

  it('shows where a figure comes from', () => {
    const whole = comparison(names, [session(9, 2, names)]);
    const mark = { start: 4, end: 6, low: 0.1, high: 0.2 };
    const plain = drawPicture(whole, new Map(), wholeView(whole), 1000, LOOK).layout.shapes ?? [];
    const shapes = drawPicture(whole, new Map(), wholeView(whole), 1000, LOOK, { session: 9, mark }).layout.shapes ?? [];
    expect(shapes).toHaveLength(plain.length + 1);
    expect(shapes.at(-1)).toMatchObject({ x0: 2, x1: 4, y0: 0.1, y1: 0.2, yref: 'y' });
    const fins = ['angle.angle_0'];
    const other = comparison(fins, [session(9, 2, fins)]);
    const alone = drawPicture(other, new Map(), wholeView(other), 1000, LOOK, { session: 9, mark }).layout.shapes ?? [];
    expect(alone.at(-1)).toMatchObject({ x0: 2, x1: 4, y0: 0, y1: 1, yref: 'y domain' });
  });
});

describe('the best value', () => {
  it('is the least, or the nearest to 0, of those that look different', () => {
    expect(bestOf([2, 1, null], { better: 'less', decimals: 1 })).toEqual(new Set([1]));
    expect(bestOf([-0.2, 0.5], { better: 'zero', decimals: 1 })).toEqual(new Set([0]));
    expect(bestOf([1.001, 1.002], { better: 'less', decimals: 2 })).toEqual(new Set());
    expect(bestOf([1, 2], { better: 'neither', decimals: 1 })).toEqual(new Set());
    expect(bestOf([1, null], { better: 'less', decimals: 1 })).toEqual(new Set());
    expect(bestOf([1, 1, 3], { better: 'less', decimals: 0 })).toEqual(new Set([0, 1]));
  });
});

describe('the address', () => {
  it('names sessions once each, and nothing else', () => {
    expect(readIds('7,9,7')).toEqual([7, 9]);
    expect(readIds('x,-1,0,2.5,')).toEqual([]);
    expect(readIds('')).toEqual([]);
  });
});
