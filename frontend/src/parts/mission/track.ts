/** The way of a mission from above, by dead reckoning: heading 0 is up. */
import type { RowRing } from '../../live/ring';

/** m along heading 0, and along heading 90° */
export type Point = readonly [x: number, y: number];

export interface Way {
  readonly points: readonly Point[];
  /** the newest point's standard deviations, m */
  readonly deviation: Point;
}

export interface Look {
  readonly line: string;
  readonly error: string;
  readonly start: string;
  readonly grid: string;
}

/** standard deviations within which 19 of 20 errors lie */
export const DEVIATIONS = 2;
/** m between two lines of the grid */
export const GRID = 1;
const POINTS_MOST = 300;
/** m that are shown at least around the way */
const MARGIN = 0.4;

/** The way between two times (s, steady clock); null where there is none. */
export function wayOf(ring: RowRing<'track'>, from: number, to: number): Way | null {
  const first = ring.firstSince(from);
  const last = ring.firstSince(to) - 1;
  if (last < first) return null;
  const [x, y] = [ring.column('x'), ring.column('y')];
  const stride = Math.max(1, Math.ceil((last - first) / POINTS_MOST));
  const points: Point[] = [];
  for (let order = last; order >= first; order -= stride) {
    const place = ring.place(order);
    points.push([x[place] ?? 0, y[place] ?? 0]);
  }
  const newest = ring.place(last);
  const deviation = [ring.column('deviation_x')[newest] ?? 0, ring.column('deviation_y')[newest] ?? 0] as const;
  return { points: points.reverse(), deviation };
}

/** Left, top, width and height of what shows the start, the way and its error, in m; whole lines of the grid. */
export function boxOf({ points, deviation }: Way): readonly [number, number, number, number] {
  const [x, y] = points.at(-1) ?? [0, 0];
  const [across, along] = [DEVIATIONS * deviation[1], DEVIATIONS * deviation[0]];
  const easts = [0, y - across, y + across, ...points.map((point) => point[1])];
  const norths = [0, x - along, x + along, ...points.map((point) => point[0])];
  const left = Math.floor((Math.min(...easts) - MARGIN) / GRID) * GRID;
  const top = -Math.ceil((Math.max(...norths) + MARGIN) / GRID) * GRID;
  const right = Math.ceil((Math.max(...easts) + MARGIN) / GRID) * GRID;
  const bottom = -Math.floor((Math.min(...norths) - MARGIN) / GRID) * GRID;
  return [left, top, right - left, bottom - top];
}

/** Draw grid, start, way, and the error of its end. */
export function paintWay(
  context: CanvasRenderingContext2D,
  way: Way,
  [left, top, wide, high]: readonly [number, number, number, number],
  look: Look,
): void {
  // A stroke is as wide at every scale.
  const pixel = window.devicePixelRatio / context.getTransform().a;
  context.lineWidth = pixel;
  context.strokeStyle = look.grid;
  context.beginPath();
  for (let at = left; at <= left + wide; at += GRID) line(context, [at, top], [at, top + high]);
  for (let at = top; at <= top + high; at += GRID) line(context, [left, at], [left + wide, at]);
  context.stroke();
  const [x, y] = way.points.at(-1) ?? [0, 0];
  context.fillStyle = look.error;
  context.beginPath();
  context.ellipse(y, -x, DEVIATIONS * way.deviation[1], DEVIATIONS * way.deviation[0], 0, 0, 2 * Math.PI);
  context.fill();
  context.lineWidth = 2 * pixel;
  context.lineJoin = 'round';
  context.strokeStyle = look.line;
  context.beginPath();
  for (const point of way.points) context.lineTo(point[1], -point[0]);
  context.stroke();
  context.fillStyle = look.start;
  dot(context, 0, 0, 3 * pixel);
  context.fillStyle = look.line;
  dot(context, y, -x, 4 * pixel);
}

function line(context: CanvasRenderingContext2D, from: Point, to: Point): void {
  context.moveTo(...from);
  context.lineTo(...to);
}

function dot(context: CanvasRenderingContext2D, x: number, y: number, radius: number): void {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}
