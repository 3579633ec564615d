/** The sessions of a long list, fetched a page at a time where one looks. */
import { api, type Session, type SessionGrouping, type SessionQuery } from '../../api';
import { Resource } from '../../resource.svelte';
import type { Group } from './placing';

const PAGE = 50;

export class SessionRows {
  #groups = new Resource<readonly Group[]>();
  #pages = new Resource();
  #query: SessionQuery = {};
  #by: SessionGrouping = 'none';
  /** of the list that is shown; answers for an earlier one are dropped */
  #turn = 0;
  /** pages that are there or under way */
  #asked: readonly number[] = [];
  /** null before the first answer */
  groups = $state.raw<readonly Group[] | null>(null);
  /** by their places in the list */
  #sessions = $state.raw<Readonly<Record<number, Session>>>({});
  readonly total = $derived((this.groups ?? []).reduce((sum, { count }) => sum + count, 0));

  get problem(): string {
    return this.#groups.problem || this.#pages.problem;
  }

  /** undefined while it is fetched */
  at(index: number): Session | undefined {
    return this.#sessions[index];
  }

  /** Show the sessions of this query, `first` of them in view; what is shown stays until they are there. */
  async load(query: SessionQuery, by: SessionGrouping, first = 0): Promise<void> {
    this.#turn += 1;
    const mine = this.#turn;
    [this.#query, this.#by] = [query, by];
    const { timeZone: zone } = Intl.DateTimeFormat().resolvedOptions();
    const page = Math.floor(first / PAGE);
    const [groups, sessions] = await Promise.all([this.#groups.ask(api.sessionGroups({ ...query, by, zone })), this.#fetch(page)]);
    if (mine !== this.#turn || groups === null || sessions === null) return;
    this.#asked = [page];
    this.#sessions = sessions;
    this.groups = groups;
  }

  /** Fetch what is missing of the rows from `first` to `last`. */
  async want(first: number, last: number): Promise<void> {
    if (this.groups === null) return;
    const mine = this.#turn;
    const end = Math.min(last, this.total - 1);
    for (let page = Math.floor(first / PAGE); page * PAGE <= end; page += 1) {
      if (this.#asked.includes(page)) continue;
      this.#asked = [...this.#asked, page];
      const sessions = await this.#fetch(page);
      if (mine !== this.#turn) return;
      if (sessions === null) this.#asked = this.#asked.filter((one) => one !== page);
      else this.#sessions = { ...this.#sessions, ...sessions };
    }
  }

  /** Show a session as the server has it now. */
  replace(session: Session): void {
    const changed = Object.entries(this.#sessions).map(([place, there]) => [place, there.id === session.id ? session : there] as const);
    this.#sessions = Object.fromEntries(changed);
  }

  async #fetch(page: number): Promise<Record<number, Session> | null> {
    const answer = await this.#pages.ask(api.sessions({ ...this.#query, by: this.#by, skip: page * PAGE, limit: PAGE }));
    return answer === null ? null : Object.fromEntries(answer.sessions.map((session, place) => [page * PAGE + place, session]));
  }
}
