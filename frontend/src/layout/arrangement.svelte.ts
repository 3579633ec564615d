import { createContext } from 'svelte';
import { api, type LayoutDocument, type SavedLayout } from '../api';
import { Arranger, type Arranged } from './arrange';
import type { ShownChart } from '../parts/panelKind';
import { FORMAT, readLayout, VERSION, type Layout, type Placed } from './layout';
import { CHART, describe } from '../panels/registry';
import type { Refusal } from '../http';
import { SHIPPED } from './shipped';
import { readStoredJson, writeStored } from '../storage';
import { layout as texts } from '../texts/layout';

const STANDARD = 'standard';
const UNDO_MOST = 100;

/** Where the panels stand, and what that is called. */
interface Standing {
  readonly panels: readonly Placed[];
  /** a shipped layout's name, or `kept/` and the number of one that the server keeps */
  readonly choice: string;
  readonly title: string;
  /** whether it is not any more what `choice` says */
  readonly changed: boolean;
  /** of the saved layout that was opened; null where there was none, or it is not known */
  readonly version: number | null;
}

type Stored = Partial<Record<'choice' | 'title' | 'changed' | 'document' | 'version', unknown>>;

/** Whether this could be a choice: the name of a shipped layout, or one that the server may have. */
export const isChoice = (text: string): boolean => /^kept\/\d{1,15}$/.test(text) || isShipped(text);

export const isShipped = (choice: string): boolean => SHIPPED.some(({ name }) => name === choice);

export const savedChoice = (id: SavedLayout['id']): string => `kept/${id}`;

/** The layout of Operate, or of replays, in this browser: which one, how it was changed, what can be undone. */
export class Arrangement {
  #now = $state.raw<Standing>(shipped(STANDARD));
  #past = $state.raw<readonly Standing[]>([]);
  arranging = $state(false);
  /** what was done last or could not be done, in words */
  message = $state('');
  /** the layouts that are saved on the server */
  saved = $state.raw<readonly SavedLayout[]>([]);
  readonly #arranger = new Arranger(describe);
  readonly #key: string;

  constructor(where: 'live' | 'replay') {
    this.#key = `mucat-layout-${where}`;
    this.#recall();
  }

  get panels(): readonly Placed[] {
    return this.#now.panels;
  }

  get choice(): string {
    return this.#now.choice;
  }

  get title(): string {
    return this.#now.title;
  }

  get changed(): boolean {
    return this.#now.changed;
  }

  /** how others get to it; null where it has no name, or is not any more what its name says */
  get named(): string | null {
    return this.changed || this.choice === '' ? null : this.choice;
  }

  get undoable(): boolean {
    return this.#past.length > 0;
  }

  get document(): Layout {
    return { format: FORMAT, version: VERSION, panels: this.panels };
  }

  /** The result of a change; nothing is changed yet. */
  try(change: (arranger: Arranger, panels: readonly Placed[]) => Arranged): Arranged {
    return change(this.#arranger, this.panels);
  }

  /** Change the layout, or tell why not. Returns whether it was. */
  do(change: (arranger: Arranger, panels: readonly Placed[]) => Arranged): boolean {
    const done = this.try(change);
    this.message = 'refused' in done ? done.refused : done.message;
    if ('refused' in done) return false;
    this.#become({ ...this.#now, panels: done.panels, changed: true });
    return true;
  }

  /** Put a panel of this kind in. Returns its id; null where there is no room. */
  add(panel: string): string | null {
    let id = panel;
    for (let number = 2; this.panels.some((one) => one.id === id); number += 1) id = `${panel} ${number}`;
    const added = { id, panel, ...(panel === CHART ? { chart: { signals: [], seconds: 60 } } : {}) };
    return this.do((arranger, panels) => arranger.add(panels, added, describe(panel).size)) ? id : null;
  }

  /** Another chart in the place of a panel's own. */
  setChart(id: string, chart: ShownChart): void {
    const panels = this.panels.map((one) => (one.id === id ? { ...one, chart } : one));
    this.#become({ ...this.#now, panels, changed: true });
  }

  undo(): void {
    const before = this.#past.at(-1);
    if (before === undefined) return;
    this.#past = this.#past.slice(0, -1);
    this.#now = before;
    this.message = texts.done.undone;
    this.#remember();
  }

  readonly reset = (): void => this.#apply(shipped(STANDARD));

  /**
   * Show another layout. Returns why not, in words; null where it is shown.
   *
   * @param remember false: this browser's own comes again after a reload, unless what is shown is changed
   */
  async choose(choice: string, remember = true): Promise<string | null> {
    if (isShipped(choice)) {
      this.#apply(shipped(choice), remember);
      return null;
    }
    const answer = await api.layout(Number(choice.replace('kept/', '')));
    if ('problem' in answer) return answer.problem;
    return this.take(answer.value.document, answer.value.name, choice, answer.value.version, remember);
  }

  /** Show what this text or object holds. Returns why not, in words; null where it is shown. */
  take(given: unknown, title: string, choice = '', version: number | null = null, remember = true): string | null {
    const layout = readLayout(given);
    if ('problem' in layout) return layout.problem;
    this.#apply({ panels: layout.panels, choice, title, changed: choice === '', version }, remember);
    return null;
  }

  /** Save it on the server under this name, `over` whatever it has there by now. Returns why not; null where it is saved. */
  async save(name: string, over = false): Promise<Refusal | null> {
    const same = this.saved.find((one) => one.name === name);
    const opened = same && savedChoice(same.id) === this.choice ? this.#now.version : (same?.version ?? 0);
    const answer = await api.saveLayout(name, this.document as LayoutDocument, over ? null : opened);
    if ('problem' in answer) return answer;
    const { id, version } = answer.value;
    this.#now = { ...this.#now, choice: savedChoice(id), title: answer.value.name, changed: false, version };
    this.message = texts.done.saved(answer.value.name);
    this.#remember();
    await this.list();
    return null;
  }

  /** Delete a layout from the server; what is shown goes on being shown. */
  async delete(id: SavedLayout['id']): Promise<string | null> {
    const problem = await api.deleteLayout(id);
    if (problem === null && this.choice === savedChoice(id)) this.#now = { ...this.#now, choice: '', changed: true };
    this.#remember();
    await this.list();
    return problem;
  }

  /** Ask the server which layouts it keeps. */
  async list(): Promise<void> {
    const answer = await api.layouts();
    if ('value' in answer) this.saved = answer.value;
  }

  /** Panels in the order in which they are read, which must not change under the hand that moves them. */
  finish(): void {
    this.arranging = false;
    this.message = '';
    this.#now = { ...this.#now, panels: inReadingOrder(this.panels) };
    this.#remember();
  }

  #apply(standing: Standing, remember = true): void {
    this.#become({ ...standing, panels: inReadingOrder(standing.panels) }, remember);
    this.message = texts.done.shown(standing.title);
  }

  #become(next: Standing, remember = true): void {
    this.#past = [...this.#past, this.#now].slice(-UNDO_MOST);
    this.#now = next;
    if (remember) this.#remember();
  }

  #remember(): void {
    const { choice, title, changed, version } = this.#now;
    writeStored(this.#key, JSON.stringify({ choice, title, changed, version, document: this.document }));
  }

  #recall(): void {
    const stored = readStoredJson(this.#key) as Stored | null;
    if (stored === null) return;
    const { choice, title, changed, version, document } = stored;
    // What comes with the program is as this version has it, and as this screen wants it.
    if (changed === false && isShipped(String(choice))) {
      this.#now = shipped(String(choice));
      return;
    }
    const layout = readLayout(document);
    if ('problem' in layout) this.message = layout.problem;
    else if (typeof choice === 'string' && typeof title === 'string') {
      this.#now = { panels: layout.panels, choice, title, changed: changed === true, version: typeof version === 'number' ? version : null };
    }
  }
}

function shipped(choice: string): Standing {
  const found = SHIPPED.find(({ name }) => name === choice);
  if (found === undefined) throw new RangeError(`no layout ${choice}`);
  return { panels: inReadingOrder(found.layout().panels), choice, title: found.title, changed: false, version: null };
}

function inReadingOrder(panels: readonly Placed[]): readonly Placed[] {
  return [...panels].sort((one, other) => one.y - other.y || one.x - other.x);
}

export const [useArrangement, provideArrangement] = createContext<Arrangement>();
