import uPlot from 'uplot';
import type { Figure } from '../../../api';
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
  /** `pale`: an earlier run; `ghost`: a prediction */
  readonly look: 'full' | 'pale' | 'ghost';
}

/** The figures that are drawn on a curve, by name. */
export type DrawnFigures = Readonly<Record<string, Figure>>;

export type What = 'values' | 'outputs';

const AXIS = 56;
/** dots of a predicted line */
const GHOST = [2, 4];
/** of the range of the values, above and below them */
const ROOM = 0.06;

interface CurvePlotOptions {
  readonly what: What;
  readonly loop: Loop;
  readonly sync: string;
  /** of the chosen run; null: none are drawn */
  readonly figures: () => DrawnFigures | null;
  readonly hover: (index: number | null) => void;
}

/** A chart of these lines; `setData(columns(…))` gives it others as long as they are as many. */
export function createCurvePlot(host: HTMLElement, lines: readonly CurveLine[], options: CurvePlotOptions): uPlot {
  const { what, loop, figures } = options;
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
        drawAxes: [drawStart, ...(values ? [(plot: uPlot) => drawBand(plot, figures())] : [])],
        draw: values ? [(plot: uPlot) => drawFigures(plot, figures())] : [],
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

function seriesOf({ label, colour, look }: CurveLine, values: boolean): uPlot.Series[] {
  const points = { show: false };
  const drawn = { label, stroke: colour, points, width: look === 'full' ? 2.25 : 1.75, alpha: look === 'pale' ? 0.5 : 1, ...(look === 'ghost' ? { dash: GHOST } : {}) };
  if (!values) return [{ ...drawn, ...(look === 'ghost' ? {} : { paths: stepped }) }];
  const setPoint = { label: texts.curves.setPointOf(label), stroke: colour, width: 1.25, dash: [6, 5], points, alpha: look === 'full' ? 0.8 : 0.35, paths: stepped };
  return [setPoint, drawn];
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

/** The band in which the value settles, from the step on. */
function drawBand(plot: uPlot, figures: DrawnFigures | null): void {
  const mark = figures?.settling_near?.mark;
  if (!mark || typeof mark.low !== 'number' || typeof mark.high !== 'number') return;
  const { ctx, bbox } = plot;
  const [left, top, bottom] = [plot.valToPos(mark.start, 'x', true), plot.valToPos(mark.low, 'y', true), plot.valToPos(mark.high, 'y', true)];
  ctx.save();
  ctx.globalAlpha = 0.16;
  ctx.fillStyle = token('accent');
  ctx.fillRect(left, Math.min(top, bottom), bbox.left + bbox.width - left, Math.abs(bottom - top));
  ctx.restore();
}

/** Rise, overshoot and settling on the curve, each with its number. */
function drawFigures(plot: uPlot, figures: DrawnFigures | null): void {
  if (figures === null) return;
  const [rise, overshoot, settling] = [placed(figures.rise_time), placed(figures.overshoot), placed(figures.settling_near)];
  const { ctx, bbox } = plot;
  const x = (at: number) => plot.valToPos(at, 'x', true);
  const y = (at: number) => plot.valToPos(at, 'y', true);
  const px = uPlot.pxRatio;
  ctx.save();
  ctx.lineWidth = 1.5 * px;
  ctx.strokeStyle = ctx.fillStyle = token('text');
  ctx.font = canvasFont('small').replace(/([\d.]+)px/, (_, size) => `${Number(size) * px}px`);
  ctx.textBaseline = 'middle';
  ctx.textAlign = 'left';
  const line = (...points: readonly (readonly [number, number])[]) => {
    ctx.beginPath();
    for (const [at, height] of points) ctx.lineTo(at, height);
    ctx.stroke();
  };
  /** Right of this place, or left of it where there is no room. */
  const label = (text: string, at: number, height: number) => {
    const width = ctx.measureText(text).width;
    const start = at + 6 * px + width > bbox.left + bbox.width ? at - 6 * px - width : at + 6 * px;
    ctx.save();
    ctx.globalAlpha = 0.85;
    ctx.fillStyle = token('panel');
    ctx.fillRect(start - 3 * px, height - 8 * px, width + 6 * px, 16 * px);
    ctx.restore();
    ctx.fillText(text, start, height);
  };
  if (rise !== null) {
    const { value, start, end, low, high } = rise;
    const falls = (figures.settling_near?.mark?.low ?? high) < low;
    const [from, to] = falls ? [high, low] : [low, high];
    line([x(start), y(from)], [x(end), y(from)], [x(end), y(to)]);
    label(texts.curves.rise(value.toFixed(1)), x(end), (y(from) + y(to)) / 2);
  }
  if (overshoot !== null) {
    const { value, end, low, high } = overshoot;
    line([x(end), y(low)], [x(end), y(high)]);
    label(texts.curves.overshoot(value.toFixed(0)), x(end), (y(low) + y(high)) / 2);
  }
  if (settling !== null) {
    const { value, end, low, high } = settling;
    const [top, bottom] = [Math.min(y(low), y(high)), Math.max(y(low), y(high))];
    line([x(end), top - 10 * px], [x(end), bottom + 10 * px]);
    label(texts.curves.settled(value.toFixed(1)), x(end), bottom + 18 * px);
  }
  ctx.restore();
}

/** A figure's value and place; null where one of them is missing. */
function placed(figure: Figure | undefined) {
  const { value, mark } = figure ?? {};
  if (typeof value !== 'number' || !mark || typeof mark.low !== 'number' || typeof mark.high !== 'number') return null;
  return { value, start: mark.start, end: mark.end, low: mark.low, high: mark.high };
}
