import { readStoredJson, writeStored } from '../storage';

const KEY = 'mucat-guide';

/** How far this browser has come with its first dive. The card comes by itself, and goes for good where somebody says so. */
export class Guide {
  /** steps that are done */
  done = $state(0);
  shown = $state(true);
  /** whether the card shows its title alone; null where nobody has chosen */
  folded = $state<boolean | null>(null);

  constructor() {
    const { done, shown, folded } = Object(readStoredJson(KEY)) as Partial<Record<'done' | 'shown' | 'folded', unknown>>;
    if (Number.isInteger(done)) this.done = Math.max(0, Number(done));
    this.shown = shown !== false;
    if (typeof folded === 'boolean') this.folded = folded;
  }

  /** So many steps are done. */
  reach(done: number): void {
    if (done !== this.done) this.#become({ done });
  }

  fold(folded: boolean): void {
    this.#become({ folded });
  }

  /** Do not come again until somebody opens it. */
  end(): void {
    this.#become({ shown: false });
  }

  /** Begin anew where all was done. */
  finish(): void {
    this.#become({ shown: false, done: 0 });
  }

  open(): void {
    this.#become({ shown: true, folded: false });
  }

  #become(changes: Partial<Pick<Guide, 'done' | 'shown' | 'folded'>>): void {
    Object.assign(this, changes);
    const { done, shown, folded } = this;
    writeStored(KEY, JSON.stringify({ done, shown, folded }));
  }
}
