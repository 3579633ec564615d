import { createContext, tick } from 'svelte';
import { api, type MissionCheck, type MissionNodeKind, type MissionPlanned, type MissionSummary, type MissionTrial } from '../../api';
import { CheckedText } from '../../parts/checked.svelte';
import { missions as texts } from '../../texts/missions';
import {
  cardAt,
  changeAt,
  copy,
  insertAt,
  moveTo,
  neighbour,
  newCard,
  newDocument,
  pathOf,
  placeText,
  readCards,
  removeAt,
  tableOf,
  walk,
  withEntry,
  type Card,
  type Cards,
  type Direction,
  type Path,
  type Place,
} from './cards';
import { NOTHING, readSource, textDraft, writeSource, type Source } from './drafts';
import { amend, begin, go, record } from './history';
import { placeProblems } from './problems';
import { figuresOf } from './trial';
import { time } from './words';
import { writeMission } from './toml';

/** A plan, the text that it is of, its steps in words, and the depth limit (m). */
export interface ShownPlan {
  readonly text: string;
  readonly plan: MissionPlanned;
  readonly steps: MissionSummary['steps'];
  readonly limit: number;
}

interface Entry {
  readonly text: string;
  /** null until the server has read the text */
  readonly cards: Cards | null;
}

/** The mission that is being written: one text, which the cards show and change. To be made while a component begins. */
export class MissionEditing {
  readonly written = new CheckedText<MissionCheck>(textDraft, (text) => api.checkMission(text));
  kinds = $state.raw<readonly MissionNodeKind[]>([]);
  /** of the missions in the library */
  names = $state.raw<readonly string[]>([]);
  /** the step whose fields are shown */
  open = $state.raw<symbol | null>(null);
  /** of the last change, for those who do not see it */
  said = $state('');
  #source = $state.raw<Source>(readSource());
  #cards = $state.raw<Entry>({ text: '', cards: null });
  #history = $state.raw(begin<Entry>({ text: this.written.text, cards: null }));
  /** who may only look at it */
  viewOnly = $state(false);
  /** while the library has another text of it than what it was opened as */
  saving = $state(false);
  /** the last dry run; null where there was none */
  trial = $state.raw<MissionTrial | null>(null);
  /** the place of the step that is pointed at, in the tree or in its picture; null without one */
  pointed = $state<string | null>(null);
  #planned = $state.raw<ShownPlan | null>(null);
  readonly #heads: Record<symbol, HTMLElement> = {};
  readonly problems = $derived(placeProblems(this.untouched ? [] : (this.written.check?.problems ?? [])));

  /** in words, of each step by its place, where the text is valid */
  readonly longest = $derived<Readonly<Record<string, string>>>(
    Object.fromEntries((this.written.current ? (this.written.check?.summary?.steps ?? []) : []).filter(({ longest }) => longest >= 1).map(({ path, longest }) => [path, time(Math.round(longest))])),
  );

  /** how often each step of the present text failed in the dry run, by its place */
  readonly failures = $derived<Readonly<Record<string, number>>>(
    Object.fromEntries(this.trial?.text === this.written.text ? figuresOf(this.trial).failures.map(({ place, count }) => [place, count]) : []),
  );

  constructor() {
    $effect(() => {
      const { check, checked } = this.written;
      if (check?.plan && check.summary) this.#planned = { text: checked, plan: check.plan, steps: check.summary.steps, limit: check.summary.depth };
    });
    $effect(() => {
      const { check, current, text } = this.written;
      if (!current || this.#cards.text === text) return;
      this.#cards = { text, cards: check?.table ? readCards(check.table) : null };
      if (this.#history.entries[this.#history.at]?.text === text) this.#history = amend(this.#history, this.#cards);
    });
  }

  get source(): Source {
    return this.#source;
  }

  /** whether there is a mission in the editor; an emptied text can be undone */
  get opened(): boolean {
    return this.written.text !== '' || this.canUndo;
  }

  /** how many seeds the present text was tried with */
  get tried(): number {
    return this.trial?.text === this.written.text ? this.trial.results.length : 0;
  }

  /** the plan of the last valid text of this mission; null before the first */
  get planned(): ShownPlan | null {
    return this.#planned;
  }

  /** whether there is something that the library does not have */
  get unsaved(): boolean {
    return this.opened && this.written.text !== this.#source.text;
  }

  /** whether it is a new mission to which nothing was added yet: nothing is lost with it, and nothing is wrong */
  get untouched(): boolean {
    return this.#source.name === '' && this.opened && !this.unsaved;
  }

  /** null where there are none, as of a text that is no TOML */
  get cards(): Cards | null {
    return this.#cards.cards;
  }

  /** whether the cards are those of the text as it stands */
  get current(): boolean {
    return this.#cards.text === this.written.text;
  }

  /** whether nothing can be changed now */
  get locked(): boolean {
    return this.viewOnly || !this.current;
  }

  get canUndo(): boolean {
    return this.#history.at > 0;
  }

  get canRedo(): boolean {
    return this.#history.at < this.#history.entries.length - 1;
  }

  /** The mark of what a mission of this name replaces; '' where it is new, null where that is not known. */
  baseOf(name: string): string | null {
    return name === this.#source.name ? this.#source.mark : '';
  }

  /** Open a mission in place of this one. */
  load({ name, text: opened, mark }: Source, text = opened): void {
    this.keep({ name, text: opened, mark });
    this.#history = begin<Entry>({ text, cards: null });
    this.open = null;
    this.#planned = null;
    this.written.text = text;
  }

  create(): void {
    const cards = newDocument(this.names);
    const text = writeMission(tableOf(cards));
    this.load({ ...NOTHING, text });
    this.#cards = { text, cards };
    this.#history = begin<Entry>(this.#cards);
    this.open = cards.root.id;
  }

  /** The text is in the library now. */
  keep(source: Source): void {
    this.#source = source;
    writeSource(source);
  }

  /** Take a text in place of the present one; `key` as in `record`. */
  write(text: string, key = ''): void {
    this.written.text = text;
    this.#history = record<Entry>(this.#history, { text, cards: null }, key);
  }

  go(by: -1 | 1): void {
    this.#history = go(this.#history, by);
    const entry = this.#history.entries[this.#history.at];
    if (entry === undefined) return;
    if (entry.cards !== null) this.#cards = entry;
    this.written.text = entry.text;
    this.said = by < 0 ? texts.editor.undone : texts.editor.redone;
  }

  #change(cards: Cards, key: string): void {
    const text = writeMission(tableOf(cards));
    this.#cards = { text, cards };
    this.written.text = text;
    this.#history = record<Entry>(this.#history, this.#cards, key);
  }

  #changeRoot(change: (root: Card) => Card | null, key = ''): Card | null {
    if (this.cards === null || this.locked) return null;
    const root = change(this.cards.root);
    if (root !== null) this.#change({ ...this.cards, root }, key);
    return root;
  }

  /** An entry of the document, or of its table `within`; undefined takes it away, and the table with its last one. */
  setHead(name: string, value: unknown, within = ''): void {
    if (this.cards === null || this.locked) return;
    const { head } = this.cards;
    const table = within === '' ? undefined : withEntry(Object(head[within]) as object as Cards['head'], name, value);
    const next = table === undefined ? withEntry(head, name, value) : withEntry(head, within, Object.keys(table).length === 0 ? undefined : table);
    this.#change({ ...this.cards, head: next }, `${within}.${name}`);
  }

  /** A change within one step, of what `key` names. */
  changeCard(path: Path, key: string, change: (card: Card) => Card): void {
    this.#changeRoot((root) => changeAt(root, path, change), `${placeText(path)} ${key}`);
  }

  async add(place: Place, kind: MissionNodeKind): Promise<void> {
    await this.#insert(place, newCard(kind), texts.editor.added);
  }

  async duplicate(path: Path): Promise<void> {
    const card = this.cards ? cardAt(this.cards.root, path) : undefined;
    const index = path.at(-1);
    if (card === undefined || index === undefined) return;
    await this.#insert({ parent: path.slice(0, -1), index: index + 1 }, copy(card), texts.editor.duplicated);
  }

  async #insert(place: Place, card: Card, say: (place: string) => string): Promise<void> {
    if (this.#changeRoot((root) => insertAt(root, place, card)) === null) return;
    this.said = say(placeText([...place.parent, place.index]));
    this.open = card.id;
    await this.focus(card.id);
  }

  async remove(path: Path): Promise<void> {
    const root = this.#changeRoot((before) => removeAt(before, path));
    if (root === null) return;
    this.said = texts.editor.removed(placeText(path));
    const parent = path.slice(0, -1);
    const next = cardAt(root, path) ?? cardAt(root, [...parent, (path.at(-1) ?? 0) - 1]) ?? cardAt(root, parent);
    if (next) await this.focus(next.id);
  }

  async move(path: Path, direction: Direction): Promise<void> {
    const place = this.cards && neighbour(this.cards.root, path, direction, this.kinds);
    if (place) await this.moveTo(path, place);
  }

  async moveTo(path: Path, place: Place): Promise<void> {
    const id = this.cards ? cardAt(this.cards.root, path)?.id : undefined;
    const root = this.#changeRoot((before) => moveTo(before, path, place, this.kinds));
    if (root === null || id === undefined) return;
    this.said = texts.editor.moved(placeText(pathOf(root, id) ?? []));
    await this.focus(id);
  }

  /** Whether it can be moved in a direction. */
  canMove(path: Path, direction: Direction): boolean {
    return this.cards !== null && neighbour(this.cards.root, path, direction, this.kinds) !== null;
  }

  canMoveTo(path: Path, place: Place): boolean {
    return this.cards !== null && moveTo(this.cards.root, path, place, this.kinds) !== null;
  }

  /** Show a step, given by its place from 1. */
  async show(place: string): Promise<void> {
    const found = this.cards && walk(this.cards.root).find(({ path }) => placeText(path) === place);
    if (!found) return;
    this.open = found.card.id;
    await this.focus(found.card.id);
  }

  /** What has the focus where this step has it; as an attachment of that. */
  readonly head = (id: symbol) => (element: HTMLElement) => {
    this.#heads[id] = element;
    return () => {
      if (this.#heads[id] === element) Reflect.deleteProperty(this.#heads, id);
    };
  };

  async focus(id: symbol): Promise<void> {
    await tick();
    this.#heads[id]?.focus();
  }

  /** Give the focus to the step that is shown before or after this one. */
  async focusBeside(id: symbol, by: -1 | 1): Promise<void> {
    const all = this.cards ? walk(this.cards.root).map(({ card }) => card.id) : [];
    const next = all[all.indexOf(id) + by];
    if (next) await this.focus(next);
  }
}

export const [useEditing, provideEditing] = createContext<MissionEditing>();
