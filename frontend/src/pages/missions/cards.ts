/** A mission's document as nested cards: what the cards show and change is the document, and nothing beside it. */
import type { MissionNodeKind } from '../../api';
import { missions as texts } from '../../texts/missions';

export type Table = Readonly<Record<string, unknown>>;
/** from the first step down, each from 0; [] is the first step itself */
export type Path = readonly number[];

/** A step. `fields` are its entries without its steps; `other` is what stands in its place and is no table. */
export interface Card {
  /** the same as long as it is the same step, wherever it is moved */
  readonly id: symbol;
  readonly fields: Table;
  readonly steps?: readonly Card[];
  readonly other?: unknown;
}

/** A document: `head` is all but the steps. */
export interface Cards {
  readonly head: Table;
  readonly root: Card;
}

export type Direction = 'up' | 'down' | 'in' | 'out';

/** A place in the list of a step. */
export interface Place {
  readonly parent: Path;
  readonly index: number;
}

const STEPS = 'steps';

export function isTable(value: unknown): value is Table {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

export function readCards(document: Table): Cards {
  const { mission, ...head } = document;
  return { head, root: readCard(mission ?? {}) };
}

function readCard(value: unknown): Card {
  const id = Symbol();
  if (!isTable(value)) return { id, fields: {}, other: value };
  const { [STEPS]: steps, ...fields } = value;
  // What is no list stays an entry, for the server to name it.
  return Array.isArray(steps) ? { id, fields, steps: steps.map(readCard) } : { id, fields: value };
}

/** The document, with the steps at the end of what is in it beside them. */
export function tableOf({ head, root }: Cards): Table {
  return { ...head, mission: valueOf(root) };
}

function valueOf({ fields, steps, other }: Card): unknown {
  if (other !== undefined) return other;
  return steps === undefined ? fields : { ...fields, [STEPS]: steps.map(valueOf) };
}

/** A new step of a kind; its required fields are yet to be filled in. */
export function newCard(kind: MissionNodeKind): Card {
  return { id: Symbol(), fields: { do: kind.do }, ...(kind.most === 0 ? {} : { steps: [] }) };
}

/** The same step again, and all below it. */
export function copy(card: Card): Card {
  return { ...card, id: Symbol(), ...(card.steps === undefined ? {} : { steps: card.steps.map(copy) }) };
}

export function cardAt(root: Card, path: Path): Card | undefined {
  return path.reduce<Card | undefined>((card, index) => card?.steps?.[index], root);
}

/** Where a step is; null where it is no more. */
export function pathOf(root: Card, id: symbol): Path | null {
  if (root.id === id) return [];
  for (const [index, step] of (root.steps ?? []).entries()) {
    const below = pathOf(step, id);
    if (below !== null) return [index, ...below];
  }
  return null;
}

/** A path as people read it, from 1: 3.1.2; empty for the first step. */
export const placeText = (path: Path): string => path.map((index) => index + 1).join('.');

export const kindOf = (card: Card, kinds: readonly MissionNodeKind[]): MissionNodeKind | undefined =>
  kinds.find((kind) => kind.do === card.fields.do);

/** Whether one more step may be put below it. */
export function hasRoom(card: Card, kinds: readonly MissionNodeKind[]): boolean {
  const kind = kindOf(card, kinds);
  if (kind === undefined || card.other !== undefined || STEPS in card.fields) return false;
  return kind.branch && (kind.most === null || (card.steps ?? []).length < kind.most);
}

/** `root` with the step at `path` replaced by what `change` makes of it. */
export function changeAt(root: Card, path: Path, change: (card: Card) => Card): Card {
  const [index, ...below] = path;
  if (index === undefined) return change(root);
  return { ...root, steps: (root.steps ?? []).map((step, at) => (at === index ? changeAt(step, below, change) : step)) };
}

/** The table with an entry changed; one that becomes undefined is left out. */
export function withEntry(table: Table, name: string, value: unknown): Table {
  return Object.fromEntries(Object.entries({ ...table, [name]: value }).filter(([, one]) => one !== undefined));
}

/** The kinds that a step may become: one with steps below it keeps them. */
export function kindsFor(card: Card, kinds: readonly MissionNodeKind[]): readonly MissionNodeKind[] {
  return (card.steps ?? []).length > 0 ? kinds.filter(({ most }) => most !== 0) : kinds;
}

/** Another kind for a step; it keeps the fields that both have. */
export function setKind(root: Card, path: Path, kind: MissionNodeKind): Card {
  const known = ['note', ...kind.fields.map(({ name }) => name)];
  return changeAt(root, path, ({ id, fields, steps = [] }) => ({
    id,
    fields: { do: kind.do, ...Object.fromEntries(Object.entries(fields).filter(([name]) => known.includes(name))) },
    ...(kind.most !== 0 || steps.length > 0 ? { steps } : {}),
  }));
}

export function insertAt(root: Card, { parent, index }: Place, card: Card): Card {
  return changeAt(root, parent, (holder) => ({ ...holder, steps: (holder.steps ?? []).toSpliced(index, 0, card) }));
}

export function removeAt(root: Card, path: Path): Card {
  return changeAt(root, path.slice(0, -1), (holder) => ({ ...holder, steps: (holder.steps ?? []).filter((_, at) => at !== path.at(-1)) }));
}

/** The place that a move in a direction leads to, as counted before the step is taken away; null where there is none. */
export function neighbour(root: Card, path: Path, direction: Direction, kinds: readonly MissionNodeKind[]): Place | null {
  const index = path.at(-1);
  if (index === undefined) return null;
  const parent = path.slice(0, -1);
  const beside = (at: number) => cardAt(root, [...parent, at]);
  if (direction === 'up') return index > 0 ? { parent, index: index - 1 } : null;
  if (direction === 'down') return beside(index + 1) ? { parent, index: index + 2 } : null;
  if (direction === 'out') {
    const at = parent.at(-1);
    const holder = parent.slice(0, -1);
    const above = cardAt(root, holder);
    return at !== undefined && above !== undefined && hasRoom(above, kinds) ? { parent: holder, index: at + 1 } : null;
  }
  const before = index > 0 ? beside(index - 1) : undefined;
  if (before && hasRoom(before, kinds)) return { parent: [...parent, index - 1], index: (before.steps ?? []).length };
  const after = beside(index + 1);
  return after && hasRoom(after, kinds) ? { parent: [...parent, index + 1], index: 0 } : null;
}

/** The step at `path` moved to a place that is counted as before; null where that is within the step itself or has no room. */
export function moveTo(root: Card, path: Path, place: Place, kinds: readonly MissionNodeKind[]): Card | null {
  const card = cardAt(root, path);
  const holder = cardAt(root, place.parent);
  const within = path.every((index, at) => place.parent[at] === index);
  if (path.length === 0 || within || card === undefined || holder === undefined) return null;
  const same = place.parent.length === path.length - 1 && place.parent.every((index, at) => path[at] === index);
  if (!same && !hasRoom(holder, kinds)) return null;
  // A second symbol marks where it was, so that no index changes before it is inserted.
  const gone: Card = { id: Symbol(), fields: {} };
  const inserted = insertAt(changeAt(root, path, () => gone), place, card);
  const emptied = pathOf(inserted, gone.id);
  return emptied === null ? null : removeAt(inserted, emptied);
}

/** All steps from the first down, as in the document. */
export function walk(card: Card, path: Path = []): { readonly card: Card; readonly path: Path }[] {
  return [{ card, path }, ...(card.steps ?? []).flatMap((step, index) => walk(step, [...path, index]))];
}

/** A name like this one that no mission has. */
export function freeName(name: string, taken: readonly string[]): string {
  const stem = name.replace(/_\d+$/, '').slice(0, 56);
  let number = 2;
  while (taken.includes(`${stem}_${number}`)) number += 1;
  return `${stem}_${number}`;
}

/** A document to begin with. */
export function newDocument(taken: readonly string[]): Cards {
  const name = taken.includes(texts.newName) ? freeName(texts.newName, taken) : texts.newName;
  return readCards({ format: 1, name, mission: { do: 'sequence', steps: [] } });
}
