import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Arrangement, isChoice } from '../src/layout/arrangement.svelte';
import { Arranger, type Arranged } from '../src/layout/arrange';
import { COLUMNS, overlaps, PANELS_MOST, readLayout, ROWS_SEEN, within, type Placed } from '../src/layout/layout';
import { describe as describePanel, PANELS } from '../src/panels/registry';
import { SHIPPED } from '../src/layout/shipped';

const least = { width: 3, height: 2 };
const arranger = new Arranger((panel) => ({ title: panel, least }));
const panel = (id: string, x: number, y: number, width: number, height: number): Placed => ({ id, panel: id, x, y, width, height });
/** a | b
 *  c c c */
const PANELS_THREE = [panel('a', 0, 0, 12, 12), panel('b', 12, 0, 12, 12), panel('c', 0, 12, 24, 12)];

const panels = (done: Arranged): readonly Placed[] => ('panels' in done ? done.panels : []);
const where = (done: Arranged, id: string) => {
  const found = panels(done).find((one) => one.id === id);
  return found && [found.x, found.y, found.width, found.height];
};

describe('Arrangement', () => {
  beforeEach(() => {
    vi.stubGlobal('window', { innerWidth: 1440 });
  });

  afterEach(() => vi.unstubAllGlobals());

  it('has a name for others until it is changed, and knows which names could be one', async () => {
    const arrangement = new Arrangement('live');
    expect(arrangement.named).toBe('standard');
    expect(await arrangement.choose('sensors', false)).toBeNull();
    expect(arrangement.named).toBe('sensors');
    const [first] = arrangement.panels;
    expect(arrangement.do((one, panels) => one.remove(panels, first?.id ?? ''))).toBe(true);
    expect(arrangement.named).toBeNull();
    arrangement.undo();
    expect(arrangement.named).toBe('sensors');
    for (const name of ['standard', 'sensors', 'kept/12']) expect(isChoice(name)).toBe(true);
    for (const nonsense of ['', 'nonsense', 'kept/', 'kept/x', 'kept/1/2', 'kept/-1', `kept/${'9'.repeat(99)}`, 'constructor']) expect(isChoice(nonsense)).toBe(false);
  });

  it('shows the layout of an address without taking it for this browser’s own', async () => {
    const stored = new Map<string, string>();
    vi.stubGlobal('localStorage', { getItem: (key: string) => stored.get(key) ?? null, setItem: (key: string, value: string) => stored.set(key, value) });
    const arrangement = new Arrangement('live');
    await arrangement.choose('sensors', false);
    expect(new Arrangement('live').named).toBe('standard');
    await arrangement.choose('sensors');
    expect(new Arrangement('live').named).toBe('sensors');
  });
});

describe('Arranger', () => {
  it('moves into free room', () => {
    const done = arranger.move([panel('a', 0, 0, 5, 5)], 'a', 3, 2);
    expect(where(done, 'a')).toEqual([3, 2, 5, 5]);
    expect(done).toHaveProperty('message', 'a: column 4, row 3.');
  });

  it('lets a panel change places with the one that it is moved into most', () => {
    const done = arranger.move(PANELS_THREE, 'a', 1, 0);
    expect([where(done, 'a'), where(done, 'b')]).toEqual([[12, 0, 12, 12], [0, 0, 12, 12]]);
    expect(done).toHaveProperty('message', 'a and b swapped places.');
  });

  it('stops at the edges', () => {
    for (const [columns, rows] of [[-1, 0], [0, -1]] as const) {
      expect(arranger.move(PANELS_THREE, 'a', columns, rows)).toEqual({ refused: 'a is at the edge.' });
    }
    expect(arranger.move(PANELS_THREE, 'b', 1, 0)).toEqual({ refused: 'b is at the edge.' });
    expect(arranger.resize(PANELS_THREE, 'b', { x: 12, y: 0, width: 13, height: 12 })).toEqual({ refused: 'b is at the edge.' });
  });

  it('takes the room to grow from its neighbours, down to their least size', () => {
    const wider = arranger.resize(PANELS_THREE, 'a', { x: 0, y: 0, width: 21, height: 12 });
    expect([where(wider, 'a'), where(wider, 'b')]).toEqual([[0, 0, 21, 12], [21, 0, 3, 12]]);
    expect(arranger.resize(PANELS_THREE, 'a', { x: 0, y: 0, width: 22, height: 12 })).toEqual({ refused: 'b cannot be smaller.' });
    const higher = arranger.resize(PANELS_THREE, 'c', { x: 0, y: 3, width: 24, height: 21 });
    expect([where(higher, 'a'), where(higher, 'b')]).toEqual([[0, 0, 12, 3], [12, 0, 12, 3]]);
  });

  it('keeps a panel at its least size, but lets what is smaller already be', () => {
    expect(arranger.resize(PANELS_THREE, 'a', { x: 0, y: 0, width: 2, height: 12 })).toEqual({ refused: 'a cannot be smaller.' });
    const small = [panel('small', 0, 0, 2, 1)];
    expect(where(arranger.move(small, 'small', 1, 0), 'small')).toEqual([1, 0, 2, 1]);
  });

  it('stands a new panel where there is room, smaller if need be, or below', () => {
    const added = { id: 'd', panel: 'd' };
    const size = { width: 8, height: 6 };
    expect(where(arranger.add([panel('a', 0, 0, 12, 24)], added, size), 'd')).toEqual([12, 0, 8, 6]);
    expect(where(arranger.add([panel('a', 0, 0, 24, 22)], added, size), 'd')).toEqual([0, 22, 3, 2]);
    expect(where(arranger.add(PANELS_THREE, added, size), 'd')).toEqual([0, 24, 8, 6]);
  });

  it('says where there is no room any more', () => {
    const many = Array.from({ length: PANELS_MOST }, (_, index) => panel(`p${index}`, index % 24, Math.floor(index / 24), 1, 1));
    expect(arranger.add(many, { id: 'd', panel: 'd' }, least)).toHaveProperty('refused');
    expect(arranger.add([panel('a', 0, 0, 24, 96)], { id: 'd', panel: 'd' }, least)).toHaveProperty('refused');
  });

  it('never lets panels lie over each other or leave the grid, whatever is done', () => {
    let seed = 20;
    const random = (below: number) => {
      // Numerical Recipes' generator: the same story at every run.
      seed = (1664525 * seed + 1013904223) % 2 ** 32;
      return Math.floor((seed / 2 ** 32) * below);
    };
    let now: readonly Placed[] = PANELS_THREE;
    let changed = 0;
    for (let step = 0; step < 800; step += 1) {
      const one = now[random(now.length)];
      const by = () => random(9) - 4;
      const kind = one === undefined ? 3 : random(5);
      let done: Arranged;
      if (one === undefined || kind === 3) done = arranger.add(now, { id: `n${step}`, panel: 'n' }, { width: 1 + random(12), height: 1 + random(12) });
      else if (kind === 4 && now.length > 6) done = arranger.remove(now, one.id);
      else if (kind === 0) done = arranger.move(now, one.id, by(), by());
      else done = arranger.resize(now, one.id, { x: one.x + (kind === 1 ? by() : 0), y: one.y, width: one.width + by(), height: one.height + by() });
      if ('refused' in done) continue;
      changed += 1;
      now = done.panels;
      expect(readLayout({ format: 'mucat-layout', version: 1, panels: now })).toHaveProperty('panels');
    }
    expect(changed).toBeGreaterThan(150);
  });
});

describe('layouts that come with the program', () => {
  it.each([1440, 2560])('stand well on a screen of %i px', (innerWidth) => {
    globalThis.window = { innerWidth } as Window & typeof globalThis;
    for (const { layout } of SHIPPED) {
      const { panels: placed } = layout();
      expect(readLayout(layout())).toEqual(layout());
      for (const one of placed) {
        expect(PANELS.some(({ name }) => name === one.panel)).toBe(true);
        const { least: needed } = describePanel(one.panel);
        expect([one.id, one.width >= needed.width && one.height >= needed.height]).toEqual([one.id, true]);
      }
      const cells = placed.reduce((sum, { width, height }) => sum + width * height, 0);
      expect(cells).toBe(COLUMNS * ROWS_SEEN);
      expect(placed.every(within)).toBe(true);
      expect(placed.some((one, at) => placed.slice(at + 1).some((other) => overlaps(one, other)))).toBe(false);
    }
  });
});

describe('readLayout', () => {
  const good = { format: 'mucat-layout', version: 1, panels: [panel('camera', 0, 0, 17, 11)] };

  it('reads text and objects', () => {
    expect(readLayout(good)).toEqual(good);
    expect(readLayout(JSON.stringify(good))).toEqual(good);
  });

  it('refuses another version before it looks at anything else', () => {
    expect(readLayout({ ...good, version: 2, panels: 'elsewhere' })).toEqual({
      problem: 'This layout has version 2. This program reads version 1. Nothing was changed.',
    });
  });

  it.each([
    ['{', 'not a panel layout'],
    [null, 'not a panel layout'],
    [[good], 'not a panel layout'],
    [{ ...good, format: 'other' }, 'not a panel layout'],
    [{ ...good, panels: {} }, 'damaged'],
    [{ ...good, panels: [...good.panels, ...good.panels] }, 'damaged'],
    [{ ...good, panels: [panel('a', 20, 0, 5, 5)] }, 'damaged'],
    [{ ...good, panels: [panel('a', 0, 0, 5.5, 5)] }, 'damaged'],
    [{ ...good, panels: [panel('a', 0, 0, 5, 0)] }, 'damaged'],
    [{ ...good, panels: [panel('a', 0, 0, 5, 5), panel('b', 4, 4, 5, 5)] }, 'damaged'],
    [{ ...good, panels: [{ ...panel('chart', 0, 0, 5, 5), chart: { signals: [7], seconds: 60 } }] }, 'damaged'],
    [{ ...good, panels: [{ ...panel('chart', 0, 0, 5, 5), chart: { signals: [], seconds: NaN } }] }, 'damaged'],
    [{ ...good, panels: [{ ...panel('chart', 0, 0, 5, 5), chart: { signals: ['a', 'a'], seconds: 60 } }] }, 'damaged'],
  ])('refuses %j', (given, word) => {
    expect(readLayout(given)).toHaveProperty('problem', expect.stringContaining(word));
  });
});
