/** Writes a mission's document as TOML: a step to a line, in inline tables, as the shipped missions are written. */
import { isTable, type Table } from './cards';

const BARE = /^[A-Za-z0-9_-]+$/;

/** The document's text. Reading it gives the same document, but for the order of entries and the kinds of whole numbers. */
export function writeMission(document: Table): string {
  const entries = Object.entries(document);
  const plain = entries.filter(([, value]) => !isTable(value));
  const tables = entries.filter((entry): entry is [string, Table] => isTable(entry[1]));
  return [writeEntries(plain), ...tables.flatMap(([name, table]) => writeTable(key(name), table, name !== 'mission'))]
    .filter((text) => text !== '')
    .join('\n');
}

/** A table under its header; `apart` gives the tables within it headers of their own. */
function writeTable(name: string, table: Table, apart: boolean): string[] {
  const entries = Object.entries(table);
  const own = apart ? entries.filter(([, value]) => !isTable(value) && !isList(value)) : entries;
  const texts = [`[${name}]\n${writeEntries(own)}`];
  for (const [inner, value] of apart ? entries : []) {
    if (isTable(value)) texts.push(...writeTable(`${name}.${key(inner)}`, value, true));
    else if (isList(value)) texts.push(...value.map((one) => `[[${name}.${key(inner)}]]\n${writeEntries(Object.entries(one))}`));
  }
  return texts;
}

/** Whether it is a list of tables alone. */
function isList(value: unknown): value is readonly Table[] {
  return Array.isArray(value) && value.length > 0 && value.every(isTable);
}

const writeEntries = (entries: readonly [string, unknown][]): string =>
  entries.map(([name, value]) => `${key(name)} = ${writeLong(value)}\n`).join('');

/** A text of several lines keeps them. */
function writeLong(value: unknown): string {
  if (typeof value !== 'string' || !value.includes('\n')) return write(value, '');
  return `"""\n${value.split('\n').map(escape).join('\n')}"""`;
}

function write(value: unknown, indent: string): string {
  if (typeof value === 'string') return quote(value);
  if (Array.isArray(value)) return writeList(value, indent);
  if (!isTable(value)) return String(value);
  const entries = Object.entries(value).map(([name, one]) => `${key(name)} = ${write(one, indent)}`);
  return entries.length === 0 ? '{}' : `{ ${entries.join(', ')} }`;
}

function writeList(list: readonly unknown[], indent: string): string {
  if (!list.some((one) => typeof one === 'object')) return `[${list.map((one) => write(one, '')).join(', ')}]`;
  // Below the first entry of an inline table, which begins after "{ ".
  const inner = `${indent}  `;
  return `[\n${list.map((one) => `${inner}${write(one, `${inner}  `)},\n`).join('')}${indent.slice(2)}]`;
}

const key = (name: string): string => (BARE.test(name) ? name : quote(name));
const quote = (text: string): string => `"${escape(text)}"`;
/** JSON has TOML's escapes, and leaves one control character as it is that TOML does not. */
const escape = (text: string): string => JSON.stringify(text).slice(1, -1).replaceAll('\u007f', '\\u007F');
