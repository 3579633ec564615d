/**
 * The events of a scenario's text, and changes of one of them: only the changed characters are written anew, by the
 * parser's places, so that comments, order and everything beside stay as somebody wrote them.
 */
import { getStaticTOMLValue, parseTOML, type AST } from 'toml-eslint-parser';

export type EventValues = Readonly<Record<string, unknown>>;

type Entries = AST.TOMLTable | AST.TOMLInlineTable;

interface WrittenEvent {
  readonly node: Entries;
  /** where it ends, with the tables below it */
  readonly end: number;
  readonly values: EventValues;
}

/** The events in the order of the text; null where it is no TOML, or they are no list of tables. */
export function readEvents(text: string): readonly EventValues[] | null {
  return parse(text)?.map(({ values }) => values) ?? null;
}

function parse(text: string): WrittenEvent[] | null {
  let program: AST.TOMLProgram;
  try {
    program = parseTOML(text);
  } catch {
    return null;
  }
  const all: unknown = getStaticTOMLValue(program).events ?? [];
  if (!Array.isArray(all)) return null;
  const nodes = program.body[0].body.flatMap((one): Entries[] => {
    if (one.type === 'TOMLTable') return one.kind === 'array' && one.resolvedKey.length === 2 && one.resolvedKey[0] === 'events' ? [one] : [];
    return nameOf(one) === 'events' && one.value.type === 'TOMLArray' ? one.value.elements.filter((element) => element.type === 'TOMLInlineTable') : [];
  });
  if (nodes.length !== all.length) return null;
  const ends = nodes.map(({ range }) => range[1]);
  for (const one of program.body[0].body) {
    if (one.type !== 'TOMLTable') continue;
    const [first, index] = one.resolvedKey;
    if (first === 'events' && typeof index === 'number') ends[index] = one.range[1];
  }
  return nodes.map((node, index) => ({ node, end: ends[index] ?? node.range[1], values: all[index] as EventValues }));
}

/** The text with a field of the event at this place changed; undefined takes it out. The text as it is where there is no such event. */
export function setField(text: string, index: number, name: string, value: unknown): string {
  const event = parse(text)?.[index];
  if (event === undefined) return text;
  const { node } = event;
  const entry = node.body.find((one) => nameOf(one) === name);
  if (value === undefined) return entry === undefined ? text : without(text, entry, node);
  const written = writeValue(value);
  if (entry !== undefined) return splice(text, entry.value.range[0], entry.value.range[1], written);
  const last = node.body.at(-1);
  if (node.type === 'TOMLInlineTable') return last ? splice(text, last.range[1], last.range[1], `, ${name} = ${written}`) : splice(text, node.range[0] + 1, node.range[0] + 1, ` ${name} = ${written} `);
  const after = last ? last.range[1] : lineEnd(text, node.key.range[1]);
  return splice(text, after, after, `\n${name} = ${written}`);
}

/** The text with one more event at its end. */
export function addEvent(text: string, values: EventValues): string {
  const entries = Object.entries(values).filter(([, value]) => value !== undefined);
  const last = parse(text)?.at(-1);
  if (last?.node.type === 'TOMLInlineTable') {
    const inline = `{ ${entries.map(([name, value]) => `${name} = ${writeValue(value)}`).join(', ')} }`;
    return splice(text, last.node.range[1], last.node.range[1], `, ${inline}`);
  }
  return `${text.trimEnd()}\n\n[[events]]\n${entries.map(([name, value]) => `${name} = ${writeValue(value)}\n`).join('')}`;
}

/** The text without the event at this place; comments above it stay. */
export function removeEvent(text: string, index: number): string {
  const event = parse(text)?.[index];
  if (event === undefined) return text;
  const { node, end } = event;
  const [start] = node.range;
  if (node.type === 'TOMLInlineTable') {
    const comma = /^\s*,/.exec(text.slice(end));
    if (comma) return splice(text, start, end + comma[0].length, '');
    const before = /,\s*$/.exec(text.slice(0, start));
    return splice(text, start - (before?.[0].length ?? 0), end, '');
  }
  const lines = /^\n\n?/.exec(text.slice(lineEnd(text, end)));
  return splice(text, start, lineEnd(text, end) + (lines?.[0].length ?? 0), '');
}

/** A value as TOML. */
function writeValue(value: unknown): string {
  return value instanceof Raw ? value.text : typeof value === 'string' ? JSON.stringify(value).replaceAll('\u007f', '\\u007F') : String(value);
}

/** A list or a table, as it is written. */
export class Raw {
  constructor(readonly text: string) {}
}

/** How a value of an event is written; '' where it is not there. */
export function fieldSource(text: string, index: number, name: string): string {
  const entry = parse(text)?.[index]?.node.body.find((one) => nameOf(one) === name);
  return entry === undefined ? '' : text.slice(...entry.value.range);
}

/** The name of an entry; of a dotted one its parts. */
const nameOf = ({ key }: AST.TOMLKeyValue): string => key.keys.map((part) => (part.type === 'TOMLBare' ? part.name : part.value)).join('.');
const splice = (text: string, from: number, to: number, insert: string) => text.slice(0, from) + insert + text.slice(to);

function lineEnd(text: string, from: number): number {
  const end = text.indexOf('\n', from);
  return end < 0 ? text.length : end;
}

function without(text: string, entry: AST.TOMLKeyValue, node: Entries): string {
  const [start, end] = entry.range;
  if (node.type === 'TOMLInlineTable') {
    const comma = /^\s*,\s*/.exec(text.slice(end));
    if (comma) return splice(text, start, end + comma[0].length, '');
    const before = /,\s*$/.exec(text.slice(0, start));
    return splice(text, start - (before?.[0].length ?? 0), end, '');
  }
  // The whole line, unless a comment stands behind.
  const behind = text.slice(end, lineEnd(text, end));
  return behind.trim() === '' ? splice(text, start, Math.min(text.length, lineEnd(text, end) + 1), '') : splice(text, start, end, '');
}
