import { expect, it } from 'vitest';
import { Live } from '../src/live/live.svelte';
import { Stop } from '../src/live/stop.svelte';
import { Handing } from '../src/panels/own/samples';
import { depthBlock, join } from './bytes';
import { readBlocks } from '../src/live/blocks';

it('hands the last minute to a panel that was opened before the robot’s clock was known', () => {
  let now = NaN;
  const live = new Live(() => now, new Stop(() => true), null);
  const handing = new Handing(live, ['depth']);
  expect(handing.next().rows.depth).toEqual([]);
  now = 100;
  for (const block of readBlocks(join(depthBlock(30, [1]), depthBlock(60, [2]), depthBlock(99, [3])).buffer)) live.take(block);
  expect(handing.next().rows.depth?.map(({ time }) => time)).toEqual([60, 99]);
  expect(handing.next().rows.depth).toEqual([]);
});
