import { describe, expect, it } from 'vitest';
import type { Cell } from '../src/api';
import { mergeCells } from '../src/live/cells';
import { CommTestWatch } from '../src/live/comm_test.svelte';
import type { CommTestActive } from '../src/live/messages';

const cell = (number: number, rate = 1): Cell => ({ number, rate }) as Cell;
const active = (run: number, done: number): CommTestActive => ({
  run,
  name: 'a test',
  place: 'emulated',
  test: 0,
  tests: 1,
  cells: 75,
  done,
  elapsed: 1,
  remaining: null,
  phase: {},
});

describe('the watch', () => {
  it('gathers the cells of the run that goes on', () => {
    const watch = new CommTestWatch();
    watch.take(active(3, 1), { run: 3, ...cell(0) });
    watch.take(active(3, 1), null);
    watch.take(active(3, 2), { run: 3, ...cell(1, 0.5) });
    expect(watch.active?.done).toBe(2);
    expect(watch.cells.map(({ number, rate }) => [number, rate])).toEqual([[0, 1], [1, 0.5]]);
  });

  it('begins anew with another run, and keeps the last one when none is under way', () => {
    const watch = new CommTestWatch();
    watch.take(active(3, 1), { run: 3, ...cell(0) });
    watch.take(active(4, 0), null);
    expect([watch.run, watch.cells]).toEqual([4, []]);
    watch.take(active(4, 1), { run: 4, ...cell(0) });
    watch.take(null, null);
    expect([watch.active, watch.run, watch.cells.length]).toEqual([null, 4, 1]);
  });

  it('believes nothing from before a lost connection', () => {
    const watch = new CommTestWatch();
    watch.take(active(3, 1), { run: 3, ...cell(0) });
    watch.reconnect();
    expect([watch.active, watch.run, watch.cells]).toEqual([null, null, []]);
  });

  it('takes no cell of another run', () => {
    const watch = new CommTestWatch();
    watch.take(active(4, 0), { run: 3, ...cell(74) });
    expect(watch.cells).toEqual([]);
  });
});

describe('cells of two sources', () => {
  it('stand once each, in order, the newer one first heard', () => {
    const merged = mergeCells([cell(2), cell(0, 0.1)], [cell(1), cell(0, 0.9)]);
    expect(merged.map(({ number, rate }) => [number, rate])).toEqual([[0, 0.9], [1, 1], [2, 1]]);
  });
});
