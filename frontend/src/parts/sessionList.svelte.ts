import { api, type SessionQuery, type Session } from '../api';
import { Resource } from '../resource.svelte';

/** A list of sessions of which more is loaded as one scrolls. */
export class SessionList {
  #request = new Resource();
  #query: SessionQuery = {};
  #turn = 0;
  /** null before the first answer */
  sessions = $state.raw<readonly Session[] | null>(null);
  /** how many match, loaded or not */
  total = $state(0);

  get problem(): string {
    return this.#request.problem;
  }

  get busy(): boolean {
    return this.#request.busy;
  }

  get complete(): boolean {
    return this.sessions !== null && this.sessions.length >= this.total;
  }

  /** Load the first page of those that match; what is shown stays until it is there. */
  async load(query: SessionQuery = {}): Promise<void> {
    this.#query = query;
    await this.#take([]);
  }

  /** Load the next page. */
  async more(): Promise<void> {
    const shown = this.sessions ?? [];
    if (!this.busy && !this.complete) await this.#take(shown);
  }

  /** Take out one that is gone from the list; the others stay where they are. */
  drop(id: Session['id']): void {
    const rest = this.sessions?.filter((session) => session.id !== id) ?? null;
    if (rest?.length === this.sessions?.length) return;
    this.sessions = rest;
    this.total -= 1;
  }

  async #take(shown: readonly Session[]) {
    this.#turn += 1;
    const mine = this.#turn;
    const last = shown.at(-1);
    const page = await this.#request.ask(api.sessions({ ...this.#query, ...(last ? { before: last.id } : {}) }));
    if (page === null || mine !== this.#turn) return;
    this.sessions = [...shown, ...page.sessions];
    // Sessions may have gone meanwhile: an empty page is the end.
    this.total = page.sessions.length > 0 ? page.total : this.sessions.length;
  }
}
