import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import type { EntryProblem } from '../src/api';
import {
  change,
  changeFault,
  countProblems,
  faultText,
  faultWords,
  listText,
  numberFields,
  numbersOf,
  problemsByField,
  problemsOfAll,
  readDocument,
  readEntry,
  readList,
  sentences,
  unreadable,
  writeDocument,
  type Fields,
} from '../src/pages/comm_tests/document';

const FIGURE_10 = readFileSync(new URL('../../firmware/examples/comm_test/figure10.json', import.meta.url), 'utf8');

function read(text: string): readonly Fields[] {
  const reading = readDocument(text);
  if ('problem' in reading) throw new Error(reading.problem);
  return reading.tests;
}

describe('the text', () => {
  it('becomes tests and text again without a change', () => {
    const written = writeDocument(read(FIGURE_10));
    expect(JSON.parse(written)).toEqual(JSON.parse(FIGURE_10));
    expect(writeDocument(read(written))).toBe(written);
    expect(written).toContain('\n    "baud_rate": [1200, 2400, 4800, 9600, 115200],\n');
  });

  it('keeps what the form does not know', () => {
    const tests = read('[{"name": "a", "colour": {"of": ["deep", 1]}, "none": null, "faults": {}}]');
    const [test] = read(writeDocument(change(tests, 0, { name: 'b' })));
    expect(test).toEqual({ name: 'b', colour: { of: ['deep', 1] }, none: null, faults: {} });
  });

  it.each([
    ['{', /not JSON/],
    ['{}', /a list/],
    ['[]', /one or more/],
    ['[1]', /an object/],
    ['[null]', /an object/],
    ['[[]]', /an object/],
  ])('is refused by the form where it is %s', (text, why) => {
    const reading = readDocument(text);
    expect('problem' in reading && reading.problem).toMatch(why);
  });
});

describe('the form', () => {
  it('changes one test of several, and leaves a field out that becomes undefined', () => {
    const tests = read('[{"name": "a", "faults": {"drop": 0.1}}, {"name": "b"}]');
    expect(change(tests, 0, { faults: undefined })).toEqual([{ name: 'a' }, { name: 'b' }]);
    expect(change(tests, 1, { name: 'c' })).toEqual([{ name: 'a', faults: { drop: 0.1 } }, { name: 'c' }]);
  });

  it('reads lists as they are typed', () => {
    expect(readList('0, 0.5 1\n2')).toEqual([0, 0.5, 1, 2]);
    expect(readList('0; 0,5; 1')).toEqual([0, 0.5, 1]);
    expect(readList('0, ')).toEqual([0]);
    expect(readList('')).toEqual([]);
    expect(readList('1e3')).toEqual([1000]);
    expect(listText([0, 0.5, 1])).toBe('0, 0.5, 1');
  });

  it('leaves what is no number to the server, which names it', () => {
    expect(readList('9600, fast')).toEqual(['9600, fast']);
    expect(unreadable(['9600, fast'])).toEqual(['“fast” is not a number.']);
    expect(readList('Infinity')).toEqual(['Infinity']);
    expect(readList('0,6')).toEqual(['0,6']);
    expect(listText([9600, 'fast'])).toBe('9600, fast');
    expect(readEntry('ten')).toBe('ten');
    expect(unreadable('1,234')).toEqual(['“1,234” can be 1.234 or 1234: enter one of these.']);
    expect(unreadable([0, 0.5])).toEqual([]);
    expect(readEntry('  ')).toBeUndefined();
  });

  it('says the last number where the thesis says the first that is not sent', () => {
    const [test = {}] = read(FIGURE_10);
    expect(numbersOf(test)).toEqual({ first: 1, last: 100 });
    expect(numberFields(1, 50)).toEqual({ from_val: 1, to_val: 51, expected: 50 });
    expect(numberFields('x', 50)).toEqual({ from_val: 'x', to_val: 51 });
    expect(numbersOf(numberFields(5, 'y'))).toEqual({ first: 5, last: 'y' });
  });

  it('has no faults where none is left', () => {
    const faults = changeFault({}, 'drop', 0.01);
    expect(faults).toEqual({ drop: 0.01 });
    expect(changeFault({ faults: { drop: 0.01 } }, 'drop', undefined)).toBeUndefined();
    // A seed stays while its fault is written anew, and may be written first.
    expect(changeFault({ faults: { drop: 0.01, seed: 3 } }, 'drop', undefined)).toEqual({ seed: 3 });
    expect(changeFault({}, 'seed', 3)).toEqual({ seed: 3 });
    expect(changeFault({ faults: { drop: 0.01, seed: 3 } }, 'insert', 0.1)).toEqual({ drop: 0.01, seed: 3, insert: 0.1 });
    expect(faultText({ faults: { burst: [0.001, 8] } }, 'burst', 1)).toBe('8');
    expect(faultText({ faults: { drop: 0.01 } }, 'drop')).toBe('0.01');
    expect(faultWords({ faults: { seed: 1, bit_errors: 0.001, stall: [2, 0.3] } })).toBe('flipped bits 0.001, a stall of 0.3 s every 2 s');
    expect(faultWords({})).toBe('');
    expect(faultText({}, 'drop')).toBe('');
    expect(faultText({ faults: 'none' }, 'stall', 0)).toBe('');
  });
});

describe('problems', () => {
  const problems: readonly EntryProblem[] = [
    problem([0, 'delay', 1], 'is -1; it must lie between 0 and 10'),
    problem([0, 'expected'], 'is 5; it must be 2'),
    problem([0, 'faults', 'bit_errors'], 'is 2; it must lie between 0 and 0.1'),
    problem([0, 'faults', 'stall', 1], 'is 9; it must be above 0 and below the period, 1 s'),
    problem([0], 'it must be an object in braces'),
    problem([11, 'name'], 'is missing'),
    problem([], 'the document has 600 cells; at most 500 can be run at once'),
  ];

  it('stand with their fields', () => {
    const first = problemsByField(problems, 0);
    const said = (field: string) => sentences(first.get(field) ?? []);
    expect([...first.keys()]).toEqual(['delay', 'expected', 'faults.bit_errors', 'faults.stall', '']);
    expect(said('faults.bit_errors')).toEqual(['It is 2; it must lie between 0 and 0.1']);
    expect(said('faults.stall')).toEqual(['Entry 2 is 9; it must be above 0 and below the period, 1 s']);
    expect(said('delay')).toEqual(['Entry 2 is -1; it must lie between 0 and 10']);
    expect(said('expected')).toEqual(['It is 5; it must be 2']);
    expect([...problemsByField(problems, 11).keys()]).toEqual(['name']);
    expect(problemsByField(problems, 1).size).toBe(0);
  });

  it('are counted by test, and those of the whole document stand apart', () => {
    expect([0, 1, 11].map((index) => countProblems(problems, index))).toEqual([5, 0, 1]);
    expect(problemsOfAll(problems)).toEqual(['the document has 600 cells; at most 500 can be run at once']);
  });
});

function problem(path: (string | number)[], words: string): EntryProblem {
  return { path, text: `${path.join(' ')} ${words}`.trim(), words };
}
