import uPlot from 'uplot';
import { canvasFont, token } from '../../../theme.svelte';
import type { Loop } from './loops';
import { tune as texts } from '../../../texts/tune';

/** A run's curve, times in s, values in the shown unit. */
export interface CurveLine {
  readonly label: string;
  readonly colour: string;
  readonly times: readonly number[];
  readonly setPoints: readonly number[];
  readonly values: readonly number[];
  readonly outputs: readonly number[];
}

export type What = 'values' | 'outputs';

const AXIS = 56;
/** of the range of the values, above and below them */
const ROOM = 0.06;

interface CurvePlotOptions {
  readonly what: What;
  readonly loop: Loop;
  readonly sync: string;
  readonly hover: (index: number | null) => void;
}

/** A chart of these lines; `setData(columns(…))` gives it others as long as they are as many. */
export function createCurvePlot(host: HTMLElement, lines: readonly CurveLine[], options: CurvePlotOptions): uPlot {
  const { what, loop } = options;
  const values = what === 'values';
  return new uPlot(
    {
      width: host.clientWidth,
      height: host.clientHeight,
      legend: { show: false },
      padding: [8, 14, 0, 0],
      cursor: { y: false, drag: { x: false, y: false }, points: { show: false }, sync: { key: options.sync } },
      scales: {
        x: { time: false },
        y: { dir: values && loop.downwards ? -1 : 1, range: (_plot, low, high) => (values ? padded(low, high) : [-1.08, 1.08]) },
      },
      axes: axesOf(options),
      series: [{}, ...lines.flatMap((line) => seriesOf(line, values))],
      hooks: {
        drawAxes: [drawStart],
        setCursor: [(plot) => options.hover(plot.cursor.left !== undefined && plot.cursor.left >= 0 ? (plot.cursor.idx ?? null) : null)],
      },
    },
    columns(lines, what),
    host,
  );
}

function axesOf({ what, loop }: CurvePlotOptions): uPlot.Axis[] {
  const grid = { stroke: token('line'), width: 1 };
  const axis = { stroke: token('muted'), font: canvasFont('small'), grid, ticks: { show: false } };
  const values = what === 'values';
  const label = (at: number) => (values ? `${Number(at.toFixed(4))} ${loop.unit}` : `${100 * at} %`);
  return [
    { ...axis, size: 28, gap: 8, values: (_plot, splits) => splits.map((at) => `${Number(at.toFixed(4))} s`.replace('-', '\u2212')) },
    {
      ...axis,
      size: AXIS,
      gap: 6,
      space: 28,
      ...(values ? {} : { splits: () => [-1, 0, 1] }),
      values: (_plot, splits) => splits.map((at) => label(at).replace('-', '\u2212')),
    },
  ];
}

function seriesOf({ label, colour }: CurveLine, values: boolean): uPlot.Series[] {
  const points = { show: false };
  if (!values) return [{ label, stroke: colour, width: 2, points, paths: stepped }];
  return [
    { label: texts.curves.setPointOf(label), stroke: colour, width: 1.25, dash: [6, 5], points, alpha: 0.8, paths: stepped },
    { label, stroke: colour, width: 2, points },
  ];
}

/** One table of all lines, whose times need not be the same. */
export function columns(lines: readonly CurveLine[], what: What): uPlot.AlignedData {
  if (lines.length === 0) return [[0, 1]];
  return uPlot.join(
    lines.map((line): uPlot.AlignedData => {
      const times = [...line.times];
      return what === 'values' ? [times, [...line.setPoints], [...line.values]] : [times, [...line.outputs]];
    }),
  );
}

const stepped: uPlot.Series.PathBuilder = (...args) => (uPlot.paths.stepped?.({ align: 1 }) ?? (() => null))(...args);

function padded(low: number, high: number): [number, number] {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  const room = Math.max((high - low) * ROOM, 1e-3);
  return [low - room, high + room];
}

/** The moment of the step. */
function drawStart(plot: uPlot): void {
  const x = Math.round(plot.valToPos(0, 'x', true));
  const { ctx, bbox } = plot;
  if (x < bbox.left || x > bbox.left + bbox.width) return;
  ctx.save();
  ctx.strokeStyle = token('line-strong');
  ctx.lineWidth = uPlot.pxRatio;
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}
