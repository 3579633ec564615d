import type { Live } from '../live/live.svelte';
import { staleAfter } from '../live/freshness';
import { Pace } from '../live/pace';
import type { Column } from '../live/ring';
import { AnglePen, unwrap, wrapRange } from './angles';
import { Columns, spanOf, type Span, type TimedColumns } from './columns';
import type { Frame } from './frame';
import { paintBand, paintFlags, paintTrace, type Scale, type Spot } from './paint';
import { depthsRange, roundRange, settle, type Range } from './range';
import type { Signal } from './signals';
import type { Strip } from './strips';
import type { View } from './view';

/** An instant to be marked; `time` in s, steady clock. */
export interface Mark {
  readonly time: number;
  readonly severity: 'info' | 'caution' | 'alarm';
}

interface Shown {
  readonly view: View;
  /** whether time stands still */
  readonly held: boolean;
  /** nothing should move more than need be */
  readonly still: boolean;
  readonly marks: readonly Mark[];
}

interface Options {
  readonly band: boolean;
  /** the value of a token of styles/tokens.css */
  readonly token: (name: string) => string;
}

interface Line {
  readonly signal: Signal;
  readonly ring: TimedColumns;
  readonly column: Column;
  readonly columns: Columns;
  readonly colour: string;
}

const SEVERITIES = { info: 'accent', caution: 'caution', alarm: 'alarm' } as const;
/**
 * Redraws per pixel that passes by, so that the line moves rather than steps, and their limits per second. The upper
 * one is well above a screen's usual 60 frames, so that of these none is left out because it came a little early.
 */
const PER_PIXEL = 2;
const RATE_LEAST = 8;
const RATE_MOST = 90;
const RATE_STILL = 1;
const DASH = [6, 5];

/** The ring and the column of a signal. */
export function source(live: Live, { topic, field, element }: Signal): { ring: TimedColumns; column: Column } {
  const ring = live.rings[topic];
  return { ring, column: (ring as { column(name: string, element: number): Column }).column(field, element) };
}

/** Draws the traces of one strip into the canvas over its frame. */
export class StripPainter {
  readonly #lines: readonly Line[];
  readonly #colours: Readonly<Record<Mark['severity'] | 'band', string>>;
  #width = 0;
  #height = 0;
  #range: Range | null = null;
  #drawn = '';
  #pace = new Pace();
  /** sum of the rings' ends when it was drawn last */
  #rows = -1;

  constructor(
    private readonly strip: Strip,
    private readonly frame: Frame,
    private readonly canvas: HTMLCanvasElement,
    private readonly live: Live,
    private readonly options: Options,
  ) {
    this.#lines = strip.traces.map(({ signal, colour }) => {
      const { ring, column } = source(live, signal);
      return { signal, ring, column, columns: new Columns(ring, column, signal.angle), colour: options.token(colour) };
    });
    const { info, caution, alarm } = SEVERITIES;
    this.#colours = {
      info: options.token(info),
      caution: options.token(caution),
      alarm: options.token(alarm),
      band: options.token('band'),
    };
    this.resize();
  }

  /** The area has another size. */
  resize(): void {
    const { clientWidth, clientHeight } = this.frame.area;
    this.#width = clientWidth;
    this.#height = clientHeight;
    this.#drawn = '';
  }

  /**
   * Draw where that shows anything else than what was drawn last; to be called at each frame of the screen, and with
   * `together` where the page's other instruments are drawn, too: new samples are drawn with them.
   */
  draw(shown: Shown, together: boolean): void {
    const { view, held, still, marks } = shown;
    if (this.#width < 2 || Number.isNaN(view.end)) return;
    const { seconds } = view;
    const rate = still ? RATE_STILL : Math.min(Math.max((PER_PIXEL * this.#width) / seconds, RATE_LEAST), RATE_MOST);
    const rings = this.#lines.reduce((sum, { ring }) => sum + ring.revision, 0);
    const rows = this.#lines.reduce((sum, { ring }) => sum + ring.end, 0);
    const picture = `${held ? view.end : ''} ${seconds} ${rings} ${marks.length} ${held}`;
    const due = !held && this.#pace.isDue(view.end, 1 / rate, together && rows !== this.#rows && !still);
    if (!due && picture === this.#drawn) return;
    this.#drawn = picture;
    this.#rows = rows;
    this.#draw(shown);
  }

  #draw({ view, held, marks }: Shown): void {
    const context = this.#clear();
    if (context === null) return;
    const span = spanOf(view, this.#width);
    const gaps = this.#lines.map(({ signal }) => staleAfter(this.live.period(signal.topic)));
    this.#lines.forEach(({ columns, ring, signal }, at) => {
      columns.update(span, gaps[at] ?? Infinity);
      if ((ring.oldest ?? -Infinity) > view.start) this.live.wantPast(signal.topic);
    });
    const range = this.#choose(span);
    const { instant } = this.live;
    this.frame.show({ seconds: view.seconds, held: held && instant ? { end: view.end, instant } : null }, range);
    const unit = ((this.strip.downwards ? 1 : -1) * this.#height) / (range[1] - range[0]);
    const scale: Scale = {
      left: span.first - view.start / span.width,
      column: 1,
      zero: -(this.strip.downwards ? range[0] : range[1]) * unit,
      unit,
    };
    const [one, other] = this.#lines;
    if (this.options.band && one && other) {
      context.fillStyle = this.#colours.band;
      paintBand(context, [one.columns, other.columns], span, scale);
    }
    context.lineJoin = 'bevel';
    this.#lines.forEach((line, at) => {
      context.strokeStyle = line.colour;
      context.lineWidth = line.signal.wanted ? 1.5 : 1.75;
      context.setLineDash(line.signal.wanted ? DASH : []);
      const [before, after] = neighbours(line, span, scale, gaps[at] ?? Infinity);
      const pen = line.signal.angle ? new AnglePen(context, scale.zero, scale.unit) : context;
      paintTrace(context, line.columns, span, scale, before, after, pen);
    });
    context.setLineDash([]);
    context.lineWidth = 1;
    const flags = marks.map(({ time, severity }) => ({ x: (time - view.start) / span.width, colour: this.#colours[severity] }));
    paintFlags(context, flags.filter(({ x }) => x >= 0 && x <= this.#width), this.#height);
  }

  #clear(): CanvasRenderingContext2D | null {
    const ratio = window.devicePixelRatio;
    const [width, height] = [Math.round(this.#width * ratio), Math.round(this.#height * ratio)];
    const { canvas } = this;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    const context = canvas.getContext('2d');
    context?.setTransform(ratio, 0, 0, ratio, 0, 0);
    context?.clearRect(0, 0, this.#width, this.#height);
    return context;
  }

  #choose(span: Span): Range {
    let least = Infinity;
    let most = -Infinity;
    for (const { columns, signal } of this.#lines) {
      const found = columns.range(span);
      if (found === null) continue;
      const range = signal.angle ? wrapRange(found) : found;
      least = Math.min(least, range[0]);
      most = Math.max(most, range[1]);
    }
    const data: Range | null = least <= most ? [least, most] : null;
    this.#range = settle(this.#range, data, this.strip.downwards ? depthsRange : roundRange);
    return this.#range;
  }
}

/** The samples next to the span on either side, where the line goes on to them. */
function neighbours(line: Line, span: Span, scale: Scale, gap: number): [Spot | null, Spot | null] {
  const { ring, column, columns, signal } = line;
  const start = span.first * span.width;
  const end = start + span.columns * span.width;
  const first = ring.firstSince(start);
  const next = ring.firstSince(end);
  const spot = (order: number, beside: number): Spot | null => {
    const place = ring.place(order);
    const read = column[place] ?? NaN;
    const value = signal.angle ? unwrap(read, beside) : read;
    if (Number.isNaN(value)) return null;
    return [scale.left + (((ring.time[place] ?? NaN) - start) / span.width) * scale.column, scale.zero + scale.unit * value];
  };
  const near = (order: number) =>
    order > 0 && order < ring.length && (ring.time[ring.place(order)] ?? 0) - (ring.time[ring.place(order - 1)] ?? 0) <= gap;
  return [near(first) ? spot(first - 1, columns.oldest(span)) : null, near(next) ? spot(next, columns.newest) : null];
}
