import { describe, expect, it } from 'vitest';
import { AnglePen, wrapRange } from '../src/charts/angles';
import { Columns, type Span } from '../src/charts/columns';
import { paintTrace, type Scale } from '../src/charts/paint';
import { ROW_TOPICS } from '../src/generated/topics';
import { RowRing } from '../src/live/ring';
import { join, rowBytes } from './bytes';

const topic = ROW_TOPICS.control;
const MANY = 60;
const SPAN: Span = { first: 0, columns: MANY, width: 1 };
const SCALE: Scale = { left: 0, column: 1, zero: 100, unit: -10 };
const WIDE = 1.75;

/** Samples of one value a column, or several where a column has a list of them. */
function columnsOf(values: readonly (number | readonly number[])[], angle = false): Columns {
  const rows = values.flatMap((value, column) => {
    const some = typeof value === 'number' ? [value] : value;
    return some.map((one, at) => rowBytes(topic, column + (at + 0.5) / some.length, { error: [one] }));
  });
  const ring = new RowRing(topic, rows.length);
  ring.append(new DataView(join(...rows).buffer), -Infinity);
  const columns = new Columns(ring, ring.column('error'), angle);
  columns.update(SPAN, 1.5);
  return columns;
}

/** What is painted: the lines, each by its corners, and how wide they are. */
function painted(columns: Columns, angle = false) {
  const lines: (readonly [number, number])[][] = [];
  const context = {
    lineWidth: WIDE,
    beginPath: () => undefined,
    moveTo: (x: number, y: number) => lines.push([[x, y]]),
    lineTo: (x: number, y: number) => lines.at(-1)?.push([x, y]),
    stroke: () => undefined,
  };
  const canvas = context as unknown as CanvasRenderingContext2D;
  paintTrace(canvas, columns, SPAN, SCALE, null, null, angle ? new AnglePen(canvas, SCALE.zero, SCALE.unit) : canvas);
  return { lines, width: context.lineWidth };
}

describe('a painted trace', () => {
  it('goes through every sample where columns hold one each', () => {
    const values = Array.from({ length: MANY }, (_, at) => Math.sin(at / 9));
    const { lines } = painted(columnsOf(values));
    expect(lines).toHaveLength(1);
    expect(lines[0]?.map(([x]) => x)).toEqual(values.map((_, at) => at + 0.5));
    lines[0]?.forEach(([, y], at) => expect(y).toBeCloseTo(100 - 10 * (values[at] ?? NaN), 4));
  });

  it('takes one segment for as long as it rests', () => {
    const values = Array.from({ length: MANY }, (_, at) => (at < 20 ? 1 : at < 40 ? 3 : 2));
    expect(painted(columnsOf(values)).lines).toEqual([
      [
        [0.5, 90],
        [19.5, 90],
        [20.5, 70],
        [39.5, 70],
        [40.5, 80],
        [59.5, 80],
      ],
    ]);
  });

  it('rests up to a column that is high, and breaks where samples are missing', () => {
    const { lines } = painted(columnsOf([1, 1, 1, [1, 3], 3, 3, [], [], 3, 3]));
    expect(lines).toEqual([
      [
        [0.5, 90],
        [2.5, 90],
        [3.25, 90],
        [3.75, 70],
        [5.5, 70],
      ],
      [
        [8.5, 70],
        [9.5, 70],
      ],
    ]);
  });

  it('is thin where it goes up and down much, within columns or from one to the next', () => {
    expect(painted(columnsOf(Array.from({ length: MANY }, (_, at) => at / MANY))).width).toBe(WIDE);
    expect(painted(columnsOf(Array.from({ length: MANY }, (_, at) => at % 2))).width).toBe(1);
    expect(painted(columnsOf(Array.from({ length: MANY }, () => [0, 1]))).width).toBe(1);
  });

  it('goes each way once where it goes up and down much', () => {
    const values = Array.from({ length: MANY }, (_, at) => (at % 3 === 0 ? [10, 0] : [0.1 * (at % 2), 9 + 0.1 * (at % 4)]));
    const [line = []] = painted(columnsOf(values)).lines;
    const way = line.slice(1).reduce((sum, [, y], at) => sum + Math.abs(y - (line[at]?.[1] ?? y)), 0);
    const heights = values.reduce((sum, [one = 0, other = 0]) => sum + 10 * Math.abs(other - one), 0);
    expect(way).toBeGreaterThanOrEqual(heights - 0.01);
    expect(way).toBeLessThan(1.1 * heights);
    values.forEach((some, at) => {
      const reached = line.filter(([x]) => Math.floor(x) === at).map(([, y]) => (100 - y) / 10);
      expect(Math.min(...reached)).toBeCloseTo(Math.min(...some), 4);
      expect(Math.max(...reached)).toBeCloseTo(Math.max(...some), 4);
    });
  });
});

describe('a painted angle', () => {
  const EDGES = [100 - 10 * Math.PI, 100 + 10 * Math.PI];
  /** The longest way up or down of any piece of the lines, px. */
  const steepest = (lines: readonly (readonly (readonly [number, number])[])[]) =>
    Math.max(...lines.flatMap((line) => line.slice(1).map(([, y], at) => Math.abs(y - (line[at]?.[1] ?? NaN)))));
  const wrapped = (angle: number) => Math.atan2(Math.sin(angle), Math.cos(angle));

  it.each([1, -1])('ends at one edge and goes on at the other where it wraps, turning %i', (way) => {
    const { lines } = painted(columnsOf([2.9, 3.1, -3.1, -2.9].map((angle) => way * angle), true), true);
    expect(lines).toHaveLength(2);
    expect(lines[0]?.at(-1)?.[1]).toBeCloseTo(EDGES[way > 0 ? 0 : 1] ?? NaN, 4);
    expect(lines[1]?.[0]?.[1]).toBeCloseTo(EDGES[way > 0 ? 1 : 0] ?? NaN, 4);
    expect(steepest(lines)).toBeLessThan(2.1);
  });

  it('has no line from edge to edge where it trembles about the wrap within its columns', () => {
    const trembling = Array.from({ length: MANY }, (_, at) => [0.02, -0.03, 0.01, -0.01].map((by) => wrapped(Math.PI + by + 0.02 * Math.sin(at))));
    const { lines } = painted(columnsOf(trembling, true), true);
    expect(steepest(lines)).toBeLessThan(1);
    for (const [, y] of lines.flat()) expect(Math.min(...EDGES.map((edge) => Math.abs(y - edge)))).toBeLessThan(1);
  });

  it('turns several times, and never leaves its range', () => {
    const { lines } = painted(columnsOf(Array.from({ length: MANY }, (_, at) => wrapped(at * 0.5)), true), true);
    expect(lines).toHaveLength(1 + Math.round((MANY * 0.5) / (2 * Math.PI)));
    expect(steepest(lines)).toBeLessThan(5.1);
    for (const [, y] of lines.flat()) expect(Math.abs(y - 100)).toBeLessThan(10 * Math.PI + 1e-6);
  });

  it('takes all of a turn only where it wraps', () => {
    expect(wrapRange([3, 3.4])).toEqual([-Math.PI, Math.PI]);
    expect(wrapRange([-0.5, 1])).toEqual([-0.5, 1]);
    const [least, most] = wrapRange([6.2, 6.4]);
    expect([least, most]).toEqual([expect.closeTo(6.2 - 2 * Math.PI, 9), expect.closeTo(6.4 - 2 * Math.PI, 9)]);
  });
});
