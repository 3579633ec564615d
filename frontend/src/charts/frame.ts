import uPlot from 'uplot';
import { calendar, type Instant } from '../live/clock';
import { canvasFont, token } from '../theme.svelte';
import type { Range } from './range';
import { ageLabel, agesBefore, momentLabel, momentsBefore, timeStep } from './ticks';

interface FrameOptions {
  readonly unit: string;
  /** values grow downwards */
  readonly downwards: boolean;
  /** whether the times stand below it */
  readonly foot: boolean;
  /** the right edge in words, while time goes on */
  readonly edge: string;
}

/** Times that the axis of time shows. */
export interface Times {
  /** s */
  readonly seconds: number;
  /** of the right edge, where the chart is held; null while it goes on */
  readonly held: { readonly end: number; readonly instant: Instant } | null;
}

const AXIS = 58;
export const FOOT = 26;
/** px between two lines of the axis of time */
const APART = 74;

/** Axes and grid of one strip, by uPlot; what is drawn in it moves, these rest. */
export class Frame {
  readonly #plot: uPlot;
  #times: Times = { seconds: 1, held: null };
  #range: Range = [0, 1];

  constructor(
    private readonly host: HTMLElement,
    options: FrameOptions,
  ) {
    this.#plot = new uPlot(
      {
        width: host.clientWidth,
        height: host.clientHeight,
        legend: { show: false },
        padding: [6, 18, options.foot ? 0 : 6, 0],
        cursor: { show: false },
        scales: {
          x: { time: false, auto: false, range: (_plot, low, high) => [low, high] },
          y: { auto: false, dir: options.downwards ? -1 : 1, range: (_plot, low, high) => [low, high] },
        },
        axes: this.#axes(options),
        series: [{}, { paths: () => null, points: { show: false } }],
      },
      [
        [-1, 0],
        [null, null],
      ],
      host,
    );
    this.#plot.setScale('y', { min: 0, max: 1 });
  }

  /** The element over the area in which is drawn. */
  get area(): HTMLElement {
    return this.#plot.over;
  }

  /** Show these axes; nothing is done where they are shown already. */
  show(times: Times, range: Range): void {
    const { seconds, held } = this.#times;
    const moved = times.seconds !== seconds || times.held?.end !== held?.end;
    if (!moved && range[0] === this.#range[0] && range[1] === this.#range[1]) return;
    this.#times = times;
    this.#range = range;
    this.#plot.batch(() => {
      this.#plot.setScale('x', { min: -times.seconds, max: 0 });
      this.#plot.setScale('y', { min: range[0], max: range[1] });
    });
  }

  resize(): void {
    this.#plot.setSize({ width: this.host.clientWidth, height: this.host.clientHeight });
  }

  destroy(): void {
    this.#plot.destroy();
  }

  #axes({ foot, edge, unit }: FrameOptions): uPlot.Axis[] {
    const grid = { stroke: token('line'), width: 1 };
    const axis = { stroke: token('muted'), font: canvasFont('small'), grid, ticks: { show: false } };
    const times: uPlot.Axis = {
      ...axis,
      size: foot ? FOOT : 0,
      gap: 8,
      splits: () => this.#splits(),
      values: (_plot, splits) => splits.map((at) => (foot ? this.#label(at, edge) : '')),
    };
    const values: uPlot.Axis = {
      ...axis,
      size: AXIS,
      gap: 6,
      space: 30,
      values: (_plot, splits) => splits.map((value) => `${Number(value.toPrecision(6))} ${unit}`.replace('-', '\u2212')),
    };
    return [times, values];
  }

  get #step(): number {
    return timeStep(this.#times.seconds, this.area.clientWidth, APART);
  }

  #splits(): number[] {
    const { seconds, held } = this.#times;
    if (held === null) return agesBefore(seconds, this.#step);
    return momentsBefore(seconds, this.#step, calendar(held.end, held.instant).getTime());
  }

  #label(at: number, edge: string): string {
    const { held } = this.#times;
    if (held === null) return at === 0 ? edge : ageLabel(at, this.#step);
    return momentLabel(calendar(held.end + at, held.instant), this.#step);
  }
}
