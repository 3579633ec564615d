/** Values of fields as they are typed. */
import type { MissionNodeKind } from '../../api';
import { readNumber } from '../../number';
import type { Card, Table } from './cards';

export type StepField = MissionNodeKind['fields'][number];
type FieldKind = StepField['kind'];

/** A value as it is typed; of a `value`, a text that would be read as something else is in quotes. */
export function fieldText(kind: FieldKind, value: unknown): string {
  if (value === undefined || value === null) return '';
  if (typeof value !== 'string') return JSON.stringify(value);
  return kind === 'value' && readField(kind, value) !== value ? JSON.stringify(value) : value;
}

/** What was typed; undefined where nothing was. What is no number stays a text, for the server to name it. */
export function readField(kind: FieldKind, typed: string, unit = ''): unknown {
  if (typed === '') return undefined;
  if (kind === 'number' || kind === 'whole') return readNumber(typed, { unit }).value ?? typed;
  if (kind !== 'value') return typed;
  if (typed === 'true' || typed === 'false') return typed === 'true';
  const quoted = /^"(.*)"$/.exec(typed)?.[1];
  return quoted === undefined ? (readNumber(typed, { unit }).value ?? typed) : unquote(typed, quoted);
}

function unquote(typed: string, inside: string): string {
  try {
    return String(JSON.parse(typed));
  } catch {
    return inside;
  }
}

/** Why a text in a field for numbers, or one that begins as a number, is none; '' where it is a number, or is meant as a text. */
export function numberProblem({ kind, unit }: StepField, value: unknown): string {
  if (typeof value !== 'string' || !(kind === 'number' || kind === 'whole' || (kind === 'value' && /^\W?\d[\d.,\s]*$/.test(value)))) return '';
  return readNumber(value, { unit, whole: kind === 'whole' }).problem;
}

/** A number in as few digits as say it to four decimals. */
export const short = (value: number): string => String(Number(value.toFixed(4)));

/** Degrees of rad. */
export const degrees = (value: number): string => String(Math.round((value * 180) / Math.PI));

/** The fields of a card that its kind does not know. */
export function unknownFields(card: Card, known: readonly StepField[]): string[] {
  return Object.keys(card.fields).filter((name) => !['do', 'note', ...known.map((one) => one.name)].includes(name));
}

/** The fields of a card in words: depth 0.6 m, within 0.05 m; 8 s. */
export function fieldWords(fields: Table, known: readonly StepField[]): string {
  return Object.entries(fields)
    .filter(([name]) => name !== 'do' && name !== 'note')
    .map(([name, value]) => {
      const field = known.find((one) => one.name === name);
      const angle = field?.unit === 'rad' && typeof value === 'number';
      // The unit says it already.
      const label = name === 'seconds' ? '' : `${name} `;
      return `${label}${angle ? `${degrees(value)}°` : fieldText(field?.kind ?? 'text', value)}${field?.unit && !angle ? ` ${field.unit}` : ''}`;
    })
    .join(', ');
}

/** The name of a kind of step, as people say it: wait for. */
export const kindWords = (name: unknown): string => (typeof name === 'string' ? name.replaceAll('_', ' ') : '');
