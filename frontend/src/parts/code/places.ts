/** Where an entry stands in a document's text: `at` and `end` are offsets in UTF-16 units. */
import { jsonLanguage } from '@codemirror/lang-json';
import { parseTOML, type AST } from 'toml-eslint-parser';

export type EntryPath = readonly (string | number)[];

export interface Place {
  readonly at: number;
  readonly end: number;
}

/** The place of each path in a text; the nearest entry above it where it stands nowhere. Null for the whole document's. */
export type FindPlace = (path: EntryPath) => Place | null;

const START: Place = { at: 0, end: 0 };

export function tomlPlaces(text: string): FindPlace {
  try {
    const top = parseTOML(text).body[0];
    return (path) => (path.length === 0 ? null : (findInTable(top, [], path) ?? null));
  } catch {
    return () => null;
  }
}

type Entries = AST.TOMLTopLevelTable | AST.TOMLTable | AST.TOMLInlineTable;

const place = ({ range }: { range: [number, number] }): Place => ({ at: range[0], end: range[1] });
const startsWith = (path: EntryPath, start: EntryPath) => start.length <= path.length && start.every((part, index) => part === path[index]);
const keyOf = (entry: AST.TOMLKeyValue): EntryPath => entry.key.keys.map((key) => (key.type === 'TOMLBare' ? key.name : key.value));

/** The deepest entry on the way to `path` in a table that stands at `here`. */
function findInTable(table: Entries, here: EntryPath, path: EntryPath): Place | undefined {
  let found: Place | undefined;
  let deepest = here.length - 1;
  for (const entry of table.body) {
    if (entry.type === 'TOMLTable') {
      if (startsWith(path, entry.resolvedKey) && entry.resolvedKey.length > deepest) {
        deepest = entry.resolvedKey.length;
        found = findInTable(entry, entry.resolvedKey, path) ?? { at: entry.range[0], end: entry.key.range[1] + 1 };
      }
      continue;
    }
    const key = [...here, ...keyOf(entry)];
    if (startsWith(path, key) && key.length > deepest) {
      deepest = key.length;
      found = findInValue(entry.value, key, path) ?? place(key.length === path.length ? entry : entry.key);
    }
  }
  return found;
}

function findInValue(value: AST.TOMLContentNode, here: EntryPath, path: EntryPath): Place | undefined {
  if (path.length === here.length) return undefined;
  if (value.type === 'TOMLInlineTable') return findInTable(value, here, path);
  const next = path[here.length];
  if (value.type !== 'TOMLArray' || typeof next !== 'number') return undefined;
  const element = value.elements[next];
  if (element === undefined) return undefined;
  // A step of many lines is marked where it begins.
  return findInValue(element, [...here, next], path) ?? { at: element.range[0], end: Math.min(element.range[1], element.range[0] + 1) };
}

export function jsonPlaces(text: string): FindPlace {
  const tree = jsonLanguage.parser.parse(text);
  const name = (from: number, to: number): unknown => {
    try {
      return JSON.parse(text.slice(from, to));
    } catch {
      return undefined;
    }
  };
  return (path) => {
    if (path.length === 0) return null;
    let node = tree.topNode.firstChild;
    let found: Place | null = null;
    for (const part of path) {
      if (node === null) break;
      const inside: typeof node | undefined =
        typeof part === 'number'
          ? node.getChildren('Value')[part] ?? [...children(node)][part]
          : node.getChildren('Property').find((one) => one.firstChild && name(one.firstChild.from, one.firstChild.to) === part);
      if (inside === undefined) break;
      found = { at: inside.from, end: inside.to };
      node = typeof part === 'number' ? inside : inside.lastChild;
    }
    return found ?? START;
  };
}

/** The values of a list, without its brackets and commas. */
function* children(node: NonNullable<ReturnType<typeof jsonLanguage.parser.parse>['topNode']['firstChild']>) {
  for (let child = node.firstChild; child; child = child.nextSibling) if (!['[', ']', ',', '⚠'].includes(child.name)) yield child;
}

/** The place that a problem names itself, as a parser's does: line and column from 1. Null where it names none. */
export function namedPlace(text: string, words: string): Place | null {
  const [, line, column] = /\bline (\d+)(?:,? column (\d+))?/.exec(words) ?? [];
  if (line === undefined) return null;
  const before = text.split('\n').slice(0, Number(line) - 1);
  const at = Math.min(text.length, before.reduce((sum, one) => sum + one.length + 1, 0) + (column === undefined ? 0 : Math.max(0, Number(column) - 2)));
  return { at, end: Math.min(text.length, at + 1) };
}
