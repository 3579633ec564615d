import { describe, expect, it } from 'vitest';
import { inOrder, nextOrder, toggle, type Column } from '../src/parts/table';

interface Run {
  readonly name: string;
  readonly rate: number | null;
}

const RUNS: readonly Run[] = [
  { name: 'run 10', rate: 0.5 },
  { name: 'run 9', rate: null },
  { name: 'run 11', rate: 0.25 },
];
const COLUMNS: readonly Column<Run>[] = [
  { heading: 'Name', sort: ({ name }) => name },
  { heading: 'Rate', sort: ({ rate }) => rate },
  { heading: 'State' },
];
const names = (heading: string, descending: boolean) => inOrder(RUNS, COLUMNS, { heading, descending }).map(({ name }) => name);

describe('rows of a table', () => {
  it('are sorted by numbers, those without one last in either direction', () => {
    expect(names('Rate', false)).toEqual(['run 11', 'run 10', 'run 9']);
    expect(names('Rate', true)).toEqual(['run 10', 'run 11', 'run 9']);
  });

  it('are sorted by text as a person counts', () => {
    expect(names('Name', false)).toEqual(['run 9', 'run 10', 'run 11']);
  });

  it('stay as they are without an order, and by a column that has none', () => {
    expect(inOrder(RUNS, COLUMNS, null)).toBe(RUNS);
    expect(names('State', true)).toEqual(['run 10', 'run 9', 'run 11']);
  });

  it('are back in their own order after the third press of a heading', () => {
    const once = nextOrder(null, 'Rate');
    const twice = nextOrder(once, 'Rate');
    expect([once, twice, nextOrder(twice, 'Rate')]).toEqual([{ heading: 'Rate', descending: false }, { heading: 'Rate', descending: true }, null]);
    expect(nextOrder(twice, 'Name')).toEqual({ heading: 'Name', descending: false });
  });
});

it('keeps the order in which rows were selected', () => {
  expect(toggle(toggle(toggle<string>([], '3'), 'table6'), '1')).toEqual(['3', 'table6', '1']);
  expect(toggle(['3', 'table6', '1'], '3')).toEqual(['table6', '1']);
});
