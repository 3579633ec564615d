import uPlot from 'uplot';
import { token } from '../theme.svelte';
import type { Point } from './envelope';

export interface Trace {
  readonly label: string;
  readonly unit: string;
  /** name of a colour in styles/tokens.css */
  readonly colour: string;
  readonly dashed?: boolean;
}

/** An instant to be marked with a flag; `at` in s relative to now. */
export interface Flag {
  readonly at: number;
  readonly severity: 'info' | 'caution' | 'alarm';
}

export interface PlotOptions {
  readonly traces: readonly Trace[];
  /** s shown before now */
  readonly seconds: number;
  /** values grow downwards */
  readonly downwards: boolean;
  /** the right edge in words */
  readonly edge: string;
  readonly unit: string;
  readonly flags: () => readonly Flag[];
  /** places of the two traces whose distance is filled */
  readonly band?: readonly [number, number];
  readonly hover: (index: number | null) => void;
}

const FONT = "12px 'Inter', system-ui, sans-serif";
const FLAG_COLOURS = { info: 'accent', caution: 'caution', alarm: 'alarm' } as const;

/** A chart in `host` whose right edge is the present moment; its data are set by `setData` and its y range by `setScale`. */
export function createPlot(host: HTMLElement, options: PlotOptions): uPlot {
  const { traces, seconds, downwards, unit } = options;
  const grid = { stroke: token('line'), width: 1 };
  const axis = { stroke: token('muted'), font: FONT, grid, ticks: { show: false } };
  const step = seconds > 60 ? 60 : 10;
  return new uPlot(
    {
      width: host.clientWidth,
      height: host.clientHeight,
      legend: { show: false },
      padding: [6, 20, 0, 0],
      cursor: { y: false, drag: { x: false, y: false }, points: { show: false } },
      scales: {
        x: { time: false, range: [-seconds, 0] },
        y: { dir: downwards ? -1 : 1, range: (_plot, low, high) => [low, high] },
      },
      axes: [
        {
          ...axis,
          size: 28,
          gap: 9,
          splits: () => Array.from({ length: seconds / step + 1 }, (_, index) => -seconds + index * step),
          values: (_plot, splits) => splits.map((at) => (at === 0 ? options.edge : timeLabel(at))),
        },
        {
          ...axis,
          size: 52,
          gap: 6,
          space: 32,
          values: (_plot, splits) => splits.map((value) => `${Number(value.toFixed(2))} ${unit}`),
        },
      ],
      series: [
        {},
        ...traces.map(
          ({ label, colour, dashed = false }): uPlot.Series => ({
            label,
            stroke: token(colour),
            width: dashed ? 1.5 : 2,
            ...(dashed ? { dash: [6, 5] } : {}),
            points: { show: false },
          }),
        ),
      ],
      hooks: {
        drawAxes: [(plot) => options.band && drawBand(plot, options.band)],
        draw: [(plot) => drawFlags(plot, options.flags())],
        setCursor: [(plot) => options.hover(plot.cursor.idx ?? null)],
      },
    },
    [[-seconds, 0], ...traces.map(() => [null, null])],
    host,
  );
}

function timeLabel(at: number): string {
  return at % 60 === 0 && at <= -60 ? `\u2212${-at / 60} min` : `\u2212${-at} s`;
}

/** Fill what lies between two traces. Each holds its last value where it has none of its own. */
function drawBand(plot: uPlot, [one, other]: readonly [number, number]): void {
  const [xs = []] = plot.data;
  const a = (plot.data[one + 1] ?? []) as readonly Point[];
  const b = (plot.data[other + 1] ?? []) as readonly Point[];
  const upper: [number, number][] = [];
  const lower: [number, number][] = [];
  const end = Math.min(a.findLastIndex(isNumber), b.findLastIndex(isNumber));
  let lastA: Point;
  let lastB: Point;
  const { ctx } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height);
  ctx.clip();
  ctx.fillStyle = token('band');
  for (let index = 0; index <= end + 1; index += 1) {
    if (a[index] !== undefined) lastA = a[index];
    if (b[index] !== undefined) lastB = b[index];
    const x = xs[index];
    if (index <= end && x !== undefined && typeof lastA === 'number' && typeof lastB === 'number') {
      const left = plot.valToPos(x, 'x', true);
      upper.push([left, plot.valToPos(lastA, 'y', true)]);
      lower.push([left, plot.valToPos(lastB, 'y', true)]);
    } else if (upper.length > 0) {
      fillBetween(ctx, upper.splice(0), lower.splice(0));
    }
  }
  ctx.restore();
}

const isNumber = (point: Point): point is number => typeof point === 'number';

function fillBetween(ctx: CanvasRenderingContext2D, upper: [number, number][], lower: [number, number][]): void {
  ctx.beginPath();
  for (const [x, y] of upper) ctx.lineTo(x, y);
  for (const [x, y] of lower.reverse()) ctx.lineTo(x, y);
  ctx.closePath();
  ctx.fill();
}

function drawFlags(plot: uPlot, flags: readonly Flag[]): void {
  const { ctx, bbox } = plot;
  const pixel = uPlot.pxRatio;
  ctx.save();
  ctx.setLineDash([]);
  for (const { at, severity } of flags) {
    const x = Math.round(plot.valToPos(at, 'x', true));
    if (x < bbox.left || x > bbox.left + bbox.width) continue;
    ctx.fillStyle = ctx.strokeStyle = token(FLAG_COLOURS[severity]);
    ctx.lineWidth = pixel;
    ctx.globalAlpha = 0.55;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.globalAlpha = 1;
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x + 9 * pixel, bbox.top + 4 * pixel);
    ctx.lineTo(x, bbox.top + 8 * pixel);
    ctx.fill();
  }
  ctx.restore();
}
