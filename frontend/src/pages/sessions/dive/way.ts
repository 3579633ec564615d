/** The track of a dive as lines seen from above and in space. */
import type { Way } from '../../../api';

/** px, or m before it is laid into a picture */
type Point = readonly [x: number, y: number];
export type View = 'above' | 'space';

export interface Laid {
  readonly estimate: string;
  readonly truth: string | null;
  /** px in a metre */
  readonly unit: number;
  readonly start: Point;
  readonly end: Point;
  /** where a time lies on the estimate */
  at: (time: number) => Point | null;
}

/** In space one looks from the south-east, a little from above. */
const ASIDE = Math.cos(Math.PI / 6);
const SLOPE = 0.45;
const MARGIN = 16;
/** m that a picture shows at least */
const LEAST = 1;

/** Right and down as the viewer sees a place, m. */
function seen(view: View, x: number, y: number, depth: number): Point {
  if (view === 'above') return [y, -x];
  return [ASIDE * (y + x), SLOPE * (y - x) + depth];
}

const points = (way: Way, view: View): Point[] => way.time.map((_, index) => seen(view, way.x[index] ?? 0, way.y[index] ?? 0, way.depth[index] ?? 0));

/** The track in the middle of a picture of this size, as large as it can be. */
export function layTrack(estimate: Way, truth: Way | null, view: View, width: number, height: number): Laid {
  const [own, real] = [points(estimate, view), truth === null ? null : points(truth, view)];
  const all = [...own, ...(real ?? [])];
  const bounds = [0, 1].map((axis) => {
    const values = all.map((point) => point[axis] ?? 0);
    return [Math.min(...values), Math.max(...values)] as const;
  });
  const [[left, right], [top, bottom]] = bounds as unknown as readonly [Point, Point];
  const unit = Math.min((width - 2 * MARGIN) / Math.max(right - left, LEAST), (height - 2 * MARGIN) / Math.max(bottom - top, LEAST));
  const lay = ([x, y]: Point): Point => [width / 2 + unit * (x - (left + right) / 2), height / 2 + unit * (y - (top + bottom) / 2)];
  const path = (line: readonly Point[]) =>
    line
      .map(lay)
      .map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`)
      .join(' ');
  const place = (index: number) => lay(own[index] ?? [0, 0]);
  return {
    estimate: path(own),
    truth: real === null ? null : path(real),
    unit,
    start: place(0),
    end: place(own.length - 1),
    at: (time) => {
      const first = estimate.time[0] ?? Infinity;
      const last = estimate.time.at(-1) ?? -Infinity;
      if (time < first || time > last) return null;
      const after = estimate.time.findIndex((one) => one >= time);
      return place(Math.max(after, 0));
    },
  };
}

/** m of a scale bar: the largest round length that is no longer than `most` px. */
export const scaleBar = (unit: number, most: number): number => [50, 20, 10, 5, 2, 1, 0.5, 0.2, 0.1].find((metres) => metres * unit <= most) ?? 0.1;

/** m between the ends of the estimate and of the true way. */
export function apart(estimate: Way, truth: Way): number {
  const end = (way: Way): readonly number[] => [way.x.at(-1) ?? 0, way.y.at(-1) ?? 0];
  const [a, b] = [end(estimate), end(truth)];
  return Math.hypot((a[0] ?? 0) - (b[0] ?? 0), (a[1] ?? 0) - (b[1] ?? 0));
}
