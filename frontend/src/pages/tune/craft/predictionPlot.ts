import uPlot from 'uplot';
import type { IdentificationResult } from '../../../api';
import { canvasFont, token } from '../../../theme.svelte';

type Channel = NonNullable<IdentificationResult['check']>['channels'][number];

/** A chart of a signal as it was measured, and as the craft before and after the fit predicts it. */
export function createPredictionPlot(host: HTMLElement, times: readonly number[], channel: Channel, colours: readonly string[]): uPlot {
  const axis = { stroke: token('muted'), font: canvasFont('small'), grid: { stroke: token('line'), width: 1 }, ticks: { show: false } };
  const words = (unit: string) => (_plot: uPlot, splits: number[]) => splits.map((at) => `${Number(at.toFixed(4))} ${unit}`.replace('-', '\u2212'));
  const points = { show: false };
  return new uPlot(
    {
      width: host.clientWidth,
      height: host.clientHeight,
      legend: { show: false },
      padding: [8, 14, 0, 0],
      cursor: { y: false, drag: { x: false, y: false }, points: { show: false } },
      scales: { x: { time: false }, y: { dir: channel.name === 'depth' ? -1 : 1 } },
      axes: [
        { ...axis, size: 28, gap: 8, values: words('s') },
        { ...axis, size: 76, gap: 6, values: words(channel.unit) },
      ],
      series: [{}, ...colours.map((stroke, place) => ({ stroke, width: place === 0 ? 2 : 1.25, points, ...(place === 1 ? { dash: [5, 4] } : {}) }))],
    },
    [[...times], [...channel.measured], [...channel.before], [...channel.after]],
    host,
  );
}
