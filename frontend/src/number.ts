/** Reads numbers as people type them. A text that can be read as two numbers is refused, and both are named. */
import { numbers as texts } from './texts/numbers';

/** A number that was read, or why none was. */
type NumberReading = { readonly value: number; readonly problem: '' } | { readonly value: null; readonly problem: string };

export interface NumberRules {
  /** what may stand behind the number */
  readonly unit?: string;
  readonly whole?: boolean;
  /** the least and the greatest; null: any */
  readonly range?: readonly [number, number] | null;
}

const SIGN = /^([-+\u2010-\u2013\u2212]?)\s*/;
/** 0.6, 0,6, .5, 5., 1e3 */
const PLAIN = /^(?=[.,]?\d)(\d*)(?:[.,](\d*))?(e[-+\u2212]?\d+)?$/i;
/** Groups of three digits, all separated alike; decimals behind another mark: 1 234, 1.234,5, 1'234.5. */
const GROUPED = /^([1-9]\d{0,2}(?<group>[.,'\u2019]|\s)\d{3}(?:\k<group>\d{3})*)(?:(?!\k<group>)[.,](\d*))?$/;
const WITH_UNIT = /^[^\p{L}]*\d\s*[\p{L}°%]\D*$/u;

/** The number in a text. One point alone is decimal, since the page itself writes numbers so. */
export function readNumber(typed: string, { unit = '', whole = false, range = null }: NumberRules = {}): NumberReading {
  const text = typed.trim();
  if (text === '') return refuse(texts.none);
  const read = readDigits(unit !== '' && text.endsWith(unit) ? text.slice(0, -unit.length).trimEnd() : text, text);
  if (read.value === null) return read.problem === texts.notNumber(text) && WITH_UNIT.test(text) ? refuse(texts.otherUnit(text, unit)) : read;
  if (whole && !Number.isInteger(read.value)) return refuse(texts.notWhole(text));
  const problem = rangeProblem(read.value, range, unit);
  return problem === '' ? read : refuse(problem);
}

/** Why a value lies outside of a range; '' where it does not. */
export function rangeProblem(value: number, range: NumberRules['range'], unit = ''): string {
  if (!range || (value >= range[0] && value <= range[1])) return '';
  const [minimum, maximum] = range.map(numberText) as [string, string];
  return range[1] === Infinity ? texts.tooSmall(numberText(value), minimum, unit) : texts.outOfRange(numberText(value), minimum, maximum, unit);
}

/** A number with all of its digits; '' for one that is none. */
export function numberText(value: number): string {
  return Number.isFinite(value) ? String(value) : '';
}

/** The numbers of a list, separated by semicolons, or else by spaces, lines and commas before a space. */
export function readNumbers(typed: string, rules: NumberRules = {}): { readonly values: readonly number[]; readonly problem: string } {
  const values: number[] = [];
  const apart = typed.includes(';');
  for (const entry of apart ? typed.split(';') : splitList(typed, rules.whole ?? false)) {
    if (entry.trim() === '') continue;
    const doubt = apart ? '' : entryProblem(entry.trim(), rules.whole ?? false);
    const { value, problem } = doubt === '' ? readNumber(entry, rules) : refuse(doubt);
    if (value === null) return { values: [], problem };
    values.push(value);
  }
  return { values, problem: '' };
}

/** The entries of a list. What may be a grouped number stays in one; among whole numbers no comma is decimal. */
function splitList(typed: string, whole: boolean): string[] {
  return typed.split(/,\s+|,$|\n/).flatMap((part) => {
    const entry = part.trim();
    if (GROUPED.test(entry)) return [entry];
    return entry.split(whole ? /[\s,]+/ : /\s+/);
  });
}

/** Why an entry of a list may be one number as well as several; '' where it cannot. */
function entryProblem(entry: string, whole: boolean): string {
  const parts = entry.split(/[,\s]/);
  if (parts.length === 1 || !parts.every((part) => /^[-\u2212]?\d+$/.test(part))) return '';
  if (parts.length > 2 && !GROUPED.test(entry)) return texts.ambiguousList(entry);
  const one = parts.length === 2 && entry.includes(',') && !whole ? parts.join('.') : parts.join('');
  return texts.ambiguousEntry(entry, one, parts.join(', '));
}

function readDigits(text: string, typed: string): NumberReading {
  const [before = '', sign = ''] = SIGN.exec(text) ?? [];
  const minus = sign === '' || sign === '+' ? '' : '-';
  const digits = text.slice(before.length);
  const plain = PLAIN.exec(digits);
  const grouped = GROUPED.exec(digits);
  if (grouped !== null && (plain === null || digits.includes(','))) {
    const whole = (grouped[1] ?? '').replace(/\D/g, '');
    // 1,234: the comma is decimal to some, and separates groups to others.
    if (plain !== null) return refuse(texts.ambiguous(typed, minus + digits.replace(',', '.'), minus + whole));
    return store(`${whole}.${grouped[3] ?? ''}`, minus, typed);
  }
  return plain === null ? refuse(texts.notNumber(typed)) : store(digits.replace(',', '.').replace('\u2212', '-'), minus, typed);
}

/** The number of digits with a decimal point, unless storing it would change it. */
function store(digits: string, minus: string, typed: string): NumberReading {
  const size = Number(digits);
  const vanished = size === 0 && /[1-9]/.test(digits.replace(/e.*/i, ''));
  if (!Number.isFinite(size) || vanished || (Number.isInteger(size) && !Number.isSafeInteger(size))) return refuse(texts.notStorable(typed));
  return { value: minus === '' || size === 0 ? size : -size, problem: '' };
}

const refuse = (problem: string): { value: null; problem: string } => ({ value: null, problem });
