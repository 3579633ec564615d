/** The test document as text and as tests: what the form shows and changes is the text, and nothing beside it. */
import type { EntryProblem } from '../../api';
import { readNumber, readNumbers, type NumberRules } from '../../number';
import { commTests as texts } from '../../texts/comm_tests';

/** One test with its fields as they stand, also those that the server will refuse. */
export type Fields = Readonly<Record<string, unknown>>;

export type Reading = { readonly tests: readonly Fields[] } | { readonly problem: string };

/** A problem of a field, or of one `entry` (from 0) of its list; `words` are the server's, without the field's name. */
export interface FieldProblem {
  readonly entry: number | null;
  readonly words: string;
}

/** How a document is looked at: all views are of the one text. */
export type View = 'summary' | 'form' | 'json';

/** The tests in `text`, or why the form cannot show them. */
export function readDocument(text: string): Reading {
  let document: unknown;
  try {
    document = JSON.parse(text);
  } catch (problem) {
    return { problem: texts.editor.notJson(problem instanceof Error ? problem.message : String(problem)) };
  }
  if (!Array.isArray(document) || document.length === 0) {
    return { problem: texts.editor.notList };
  }
  const entries: readonly unknown[] = document;
  if (!entries.every(isFields)) return { problem: texts.editor.notObject };
  return { tests: entries };
}

function isFields(value: unknown): value is Fields {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/** The document's text as the thesis's Figure 10 is written: a field to a line, and lists of numbers on one. */
export function writeDocument(tests: readonly Fields[]): string {
  return `${write(tests, '')}\n`;
}

function write(value: unknown, indent: string): string {
  const inner = `${indent}  `;
  if (Array.isArray(value)) {
    if (value.every((one) => typeof one !== 'object')) return `[${value.map((one) => write(one, '')).join(', ')}]`;
    return `[\n${value.map((one) => inner + write(one, inner)).join(',\n')}\n${indent}]`;
  }
  if (isFields(value)) {
    const fields = Object.entries(value).map(([name, one]) => `${inner}${JSON.stringify(name)}: ${write(one, inner)}`);
    return fields.length === 0 ? '{}' : `{\n${fields.join(',\n')}\n${indent}}`;
  }
  return JSON.stringify(value);
}

/** `tests` with some fields of one of them changed; a field that becomes undefined is left out. */
export function change(tests: readonly Fields[], index: number, changes: Fields): Fields[] {
  return tests.map((test, at) => (at === index ? without(Object.entries({ ...test, ...changes })) : test));
}

function without(entries: readonly [string, unknown][]): Fields {
  return Object.fromEntries(entries.filter(([, value]) => value !== undefined));
}

/** A list as it is typed: 0, 0.5, 1. */
export function listText(value: unknown): string {
  if (value === undefined) return '';
  return Array.isArray(value) ? value.map((one) => entryText(one)).join(', ') : entryText(value);
}

function entryText(value: unknown): string {
  return typeof value === 'string' ? value : JSON.stringify(value);
}

/** What was typed as a list; what cannot be read stays as it is, and the server refuses it, too. */
export function readList(text: string, rules: NumberRules = {}): (number | string)[] {
  const { values, problem } = readNumbers(text, rules);
  return problem === '' ? [...values] : [text];
}

/** What was typed as one number; undefined where nothing was. */
export function readEntry(text: string, rules: NumberRules = {}): number | string | undefined {
  return text.trim() === '' ? undefined : (readNumber(text, rules).value ?? text);
}

/** Why a list of numbers, or one number, cannot be read as it stands; none where it can, or where there is none. */
export function unreadable(value: unknown, rules: NumberRules = {}): string[] {
  const entries: readonly unknown[] = Array.isArray(value) ? value : [value];
  return entries.flatMap((one) => {
    if (typeof one !== 'string' || one === '') return [];
    const { problem } = Array.isArray(value) ? readNumbers(one, rules) : readNumber(one, rules);
    return problem === '' ? [] : [problem];
  });
}

/** The first and the last number of a test; `to_val` is the first that is not sent. */
export function numbersOf(test: Fields): { first: unknown; last: unknown } {
  return { first: test.from_val, last: typeof test.to_val === 'number' ? test.to_val - 1 : test.to_val };
}

/** The thesis's three fields that say which numbers are sent. */
export function numberFields(first: unknown, last: unknown): Fields {
  const to = typeof last === 'number' ? last + 1 : last;
  const expected = typeof first === 'number' && typeof to === 'number' ? to - first : undefined;
  return { from_val: first, to_val: to, ...(expected === undefined ? {} : { expected }) };
}

/** `test.faults` with one entry changed; undefined where none is left, so that the field goes. A seed alone stays. */
export function changeFault(test: Fields, name: string, value: unknown): Fields | undefined {
  const before = isFields(test.faults) ? test.faults : {};
  const faults = without(Object.entries({ ...before, [name]: value }));
  return Object.keys(faults).length > 0 ? faults : undefined;
}

/** One entry of `test.faults`, or what is at a place of its pair. */
export function faultValue(test: Fields, name: string, place?: number): unknown {
  const value = isFields(test.faults) ? test.faults[name] : undefined;
  if (place === undefined) return value;
  const pair: readonly unknown[] = Array.isArray(value) ? value : [];
  return pair[place];
}

/** One entry of `test.faults`, as it is typed. */
export function faultText(test: Fields, name: string, place?: number): string {
  const one = faultValue(test, name, place);
  return one === undefined || one === null ? '' : entryText(one);
}

/** The summaries of faults, by the fault's field. */
const FAULTS: Readonly<Record<string, (value: string, second: string) => string>> = texts.faults.summary;

/** Whether `FaultFields` shows the problems of the field of this name. */
export function isFault(name: string): boolean {
  return ['faults', 'faults.seed', ...Object.keys(FAULTS).map((one) => `faults.${one}`)].includes(name);
}

/** The faults of a test's line in words; '' where there are none. */
export function faultWords(test: Fields): string {
  return Object.entries(FAULTS)
    .map(([name, say]) => {
      const pair = Array.isArray(isFields(test.faults) ? test.faults[name] : undefined);
      const first = faultText(test, name, pair ? 0 : undefined);
      return first === '' ? '' : say(first, faultText(test, name, 1));
    })
    .filter((words) => words !== '')
    .join(', ');
}

/** The problems of the test at `index`, by the field that they are about: delay, faults.drop; '' where it is the test itself. */
export function problemsByField(problems: readonly EntryProblem[], index: number): ReadonlyMap<string, readonly FieldProblem[]> {
  const found = new Map<string, FieldProblem[]>();
  for (const { path, words } of problems) {
    const [test, ...within] = path;
    if (test !== index) continue;
    const field = within.filter((one) => typeof one === 'string').join('.');
    const last = within.at(-1);
    found.set(field, [...(found.get(field) ?? []), { entry: typeof last === 'number' ? last : null, words }]);
  }
  return found;
}

/** The problems of the whole document, which belong to no test. */
export function problemsOfAll(problems: readonly EntryProblem[]): string[] {
  return problems.filter(({ path }) => path.length === 0).map(({ text }) => text);
}

/** How many problems the test at `index` has. */
export function countProblems(problems: readonly EntryProblem[], index: number): number {
  return problems.filter(({ path }) => path[0] === index).length;
}

/** Problems as sentences about a field. */
export function sentences(problems: readonly FieldProblem[]): string[] {
  return problems.map(({ entry, words }) => texts.editor.problem(entry, words));
}
