import type { Pen } from './angles';
import { Order, type Columns, type Span } from './columns';

/** Where columns and values lie on the canvas, in pixels. */
export interface Scale {
  /** of the left edge of the span's first column */
  readonly left: number;
  /** of one column */
  readonly column: number;
  /** of the value 0, and of one unit upwards (negative) or downwards */
  readonly zero: number;
  readonly unit: number;
}

/** A sample, in pixels. */
export type Spot = readonly [x: number, y: number];

/** px that a trace goes up and down in each column, on average, from which on its line is thin */
const DENSE = 4;
const THIN = 1;

/**
 * Draw a trace: in each column its least and its greatest value in the order in which they came, joined by lines.
 *
 * `before` and `after` are the samples next to the span, to which the line goes on where it does. Where it goes
 * up and down much, as with noise, the line is thin: wide ones that lie so close take a browser ten times as long. It
 * then begins each column at the nearer end, since the order cannot be seen and the way between is drawn twice else.
 *
 * `pen` draws the line on `context`; that itself where it is left out.
 */
export function paintTrace(
  context: CanvasRenderingContext2D,
  columns: Columns,
  span: Span,
  scale: Scale,
  before: Spot | null,
  after: Spot | null,
  pen: Pen = context,
): void {
  const dense = travel(columns, span) * Math.abs(scale.unit) > DENSE;
  if (dense) context.lineWidth = THIN;
  const { low, high, order, broken } = columns;
  const { left, column, zero, unit } = scale;
  let open = before !== null;
  // Where the level part ends that is not drawn yet: a line that rests costs no more than one segment.
  let level = NaN;
  let y = before?.[1] ?? NaN;
  const rest = () => {
    if (!Number.isNaN(level)) pen.lineTo(level, y);
    level = NaN;
  };
  context.beginPath();
  if (before !== null) pen.moveTo(...before);
  for (let index = 0; index < span.columns; index += 1) {
    const place = columns.place(span.first + index);
    const kind = order[place];
    if (kind === Order.NONE) continue;
    const least = zero + unit * (low[place] ?? NaN);
    const most = zero + unit * (high[place] ?? NaN);
    const x = left + index * column;
    if (broken[place] === 1) {
      rest();
      open = false;
    }
    if (least === most) {
      if (open && least === y) level = x + column / 2;
      else {
        rest();
        if (open) pen.lineTo(x + column / 2, least);
        else pen.moveTo(x + column / 2, least);
      }
      y = least;
    } else {
      rest();
      const rising = dense && open ? Math.abs(least - y) < Math.abs(most - y) : kind === Order.RISING;
      const begin = rising ? least : most;
      if (open) pen.lineTo(x + column / 4, begin);
      else pen.moveTo(x + column / 4, begin);
      y = rising ? most : least;
      pen.lineTo(x + 0.75 * column, y);
    }
    open = true;
  }
  rest();
  if (after !== null && open) pen.lineTo(...after);
  context.stroke();
}

/** Mean extent of a trace in each column, in its own unit, the way from column to column included. */
function travel({ low, high, order, place }: Columns, { first, columns: many }: Span): number {
  let sum = 0;
  let last = NaN;
  for (let number = first; number < first + many; number += 1) {
    const at = place(number);
    const kind = order[at];
    if (kind === Order.NONE) continue;
    const least = low[at] ?? NaN;
    const most = high[at] ?? NaN;
    const begin = kind === Order.RISING ? least : most;
    if (!Number.isNaN(last)) sum += Math.abs(begin - last);
    sum += most - least;
    last = kind === Order.RISING ? most : least;
  }
  return sum / many;
}

/** Fill what lies between two traces. Each holds its last value where it has none of its own. */
export function paintBand(
  context: CanvasRenderingContext2D,
  [one, other]: readonly [Columns, Columns],
  { first, columns: many }: Span,
  { left, column, zero, unit }: Scale,
): void {
  const upper: Spot[] = [];
  const lower: Spot[] = [];
  const last: [number, number] = [NaN, NaN];
  const fill = () => {
    context.beginPath();
    for (const [x, y] of upper.splice(0)) context.lineTo(x, y);
    for (const [x, y] of lower.splice(0).reverse()) context.lineTo(x, y);
    context.fill();
  };
  const end = Math.min(newest(one, first, many), newest(other, first, many));
  for (let number = first; number <= end; number += 1) {
    [one, other].forEach((columns, trace) => {
      const place = columns.place(number);
      if (columns.broken[place] === 1) fill();
      if (columns.order[place] !== Order.NONE) last[trace] = ((columns.low[place] ?? NaN) + (columns.high[place] ?? NaN)) / 2;
    });
    if (Number.isNaN(last[0]) || Number.isNaN(last[1])) continue;
    const x = left + (number - first + 0.5) * column;
    upper.push([x, zero + unit * last[0]]);
    lower.push([x, zero + unit * last[1]]);
  }
  fill();
}

function newest(columns: Columns, first: number, many: number): number {
  let number = first + many - 1;
  while (number >= first && columns.order[columns.place(number)] === Order.NONE) number -= 1;
  return number;
}

/** An instant to be marked with a flag. */
interface Flag {
  readonly x: number;
  readonly colour: string;
}

export function paintFlags(context: CanvasRenderingContext2D, flags: readonly Flag[], height: number): void {
  for (const { x, colour } of flags) {
    context.fillStyle = context.strokeStyle = colour;
    context.globalAlpha = 0.55;
    context.beginPath();
    context.moveTo(x, 0);
    context.lineTo(x, height);
    context.stroke();
    context.globalAlpha = 1;
    context.beginPath();
    context.moveTo(x, 0);
    context.lineTo(x + 9, 4);
    context.lineTo(x, 8);
    context.fill();
  }
}
