import { describe, expect, it } from 'vitest';
import { Columns, Order, spanOf, type Span } from '../src/charts/columns';
import { SPANS, viewUntil } from '../src/charts/view';
import { ROW_TOPICS } from '../src/generated/topics';
import { RowRing } from '../src/live/ring';
import { join, rowBytes } from './bytes';

const topic = ROW_TOPICS.control;
/** Rows of a time and a value each. */
const rows = (samples: readonly (readonly [number, number])[]) =>
  new DataView(join(...samples.map(([time, error]) => rowBytes(topic, time, { error: [error] }))).buffer);

function series(samples: readonly (readonly [number, number])[], capacity = samples.length) {
  const ring = new RowRing(topic, capacity);
  ring.append(rows(samples), -Infinity);
  return { ring, columns: new Columns(ring, ring.column('error')) };
}

interface Seen {
  column: number;
  values: number[];
  broken: boolean;
}

/** What lies in the columns that are not empty, in order. */
function seen(columns: Columns, { first, columns: many }: Span): Seen[] {
  return Array.from({ length: many }, (_, index) => index).flatMap((column) => {
    const place = columns.place(first + column);
    const order = columns.order[place];
    if (order === Order.NONE) return [];
    const [low = NaN, high = NaN] = [columns.low[place], columns.high[place]];
    const values = low === high ? [low] : order === Order.RISING ? [low, high] : [high, low];
    return [{ column, values, broken: columns.broken[place] === 1 }];
  });
}

const at100Hz = (seconds: number, value: (index: number) => number) =>
  Array.from({ length: seconds * 100 }, (_, index) => [1000 + index / 100, value(index)] as const);

describe('Columns', () => {
  it.each(SPANS.map(({ seconds }) => seconds))('loses no spike of one sample in %i s at 100 Hz', (seconds) => {
    const spike = seconds * 50 + 21;
    const { columns } = series(at100Hz(seconds, (index) => (index === spike ? 9 : index === spike + 1 ? -9 : 1)));
    for (const pixels of [60, 333, 1300]) {
      const span = spanOf(viewUntil(1000 + seconds, seconds), pixels);
      columns.update(span, 1);
      expect(columns.range(span)).toEqual([-9, 9]);
    }
  });

  it('gives least and greatest in the order in which they came', () => {
    const { columns } = series([
      [0.1, 5],
      [0.2, 7],
      [0.3, 2],
      [1.1, 1],
      [1.2, 3],
    ]);
    const span = { first: 0, columns: 2, width: 1 };
    columns.update(span, 10);
    expect(seen(columns, span).map(({ values }) => values)).toEqual([
      [7, 2],
      [1, 3],
    ]);
  });

  it('is the same whether it followed the samples one by one or looks at all of them at once', () => {
    const samples = at100Hz(90, (index) => Math.sin(index * 0.7) + (index % 997 === 0 ? 5 : 0));
    const { ring, columns } = series(samples.slice(0, 100), 6100);
    for (let end = 1; end < 90; end += 0.04) {
      ring.append(rows(samples.slice(Math.round(100 * end), Math.round(100 * (end + 0.04)))), -Infinity);
      columns.update(spanOf(viewUntil(1000 + end, 60), 777), 1);
    }
    const span = spanOf(viewUntil(1089.5, 60), 777);
    const anew = new Columns(ring, ring.column('error'));
    columns.update(span, 1);
    anew.update(span, 1);
    expect(seen(columns, span)).toEqual(seen(anew, span));
    expect(seen(columns, span).length).toBeGreaterThan(770);
  });

  it('looks at each sample once while time goes on', () => {
    const { ring } = series(at100Hz(60, (index) => index), 7000);
    let looks = 0;
    const counted = new Columns(
      {
        time: ring.time,
        oldest: ring.oldest,
        get length() {
          return ring.length;
        },
        get end() {
          return ring.end;
        },
        get revision() {
          return ring.revision;
        },
        place: (order) => {
          looks += 1;
          return ring.place(order);
        },
        firstSince: (time) => ring.firstSince(time),
      },
      ring.column('error'),
    );
    counted.update(spanOf(viewUntil(1060, 60), 600), 1);
    looks = 0;
    ring.append(rows([[1060.01, 1], [1060.02, 2]]), -Infinity);
    counted.update(spanOf(viewUntil(1060.05, 60), 600), 1);
    expect(looks).toBe(2);
  });

  it('lets the line run on over empty columns, and breaks it where samples are missing or are no number', () => {
    const { columns } = series([
      [0.5, 1],
      [3.5, 2],
      [8.5, 3],
      [9.5, NaN],
      [10.5, 4],
    ]);
    const span = { first: 0, columns: 12, width: 1 };
    columns.update(span, 4);
    expect(seen(columns, span).map(({ column, broken }) => [column, broken])).toEqual([
      [0, false],
      [3, false],
      [8, true],
      [10, true],
    ]);
  });

  it('begins anew where older rows have come, the ring was cleared, or time goes back', () => {
    const { ring, columns } = series([[5.5, 1]], 10);
    const span = { first: 0, columns: 10, width: 1 };
    columns.update(span, 100);
    ring.prepend(rows([[1.5, 7], [2.5, 8]]));
    columns.update(span, 100);
    expect(seen(columns, span).map(({ values }) => values)).toEqual([[7], [8], [1]]);
    columns.update({ ...span, first: 4 }, 100);
    columns.update({ ...span, first: 2 }, 100);
    expect(seen(columns, { ...span, first: 2 }).map(({ values }) => values)).toEqual([[8], [1]]);
    ring.clear();
    columns.update(span, 100);
    expect(seen(columns, span)).toEqual([]);
  });
});
