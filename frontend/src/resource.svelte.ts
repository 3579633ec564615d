import type { Answer, Refusal } from './http';

/** A request to the server as a component shows it: under way or not, what it brought, and why it failed. */
export class Resource<Value = null> {
  /** what was brought last; null before */
  value = $state.raw<Value | null>(null);
  /** whether a request is under way */
  busy = $state(false);
  /** why the last request failed, in words; '' where it did not */
  problem = $state('');
  /** whether it failed since somebody else has changed the thing meanwhile */
  changed = $state(false);
  #newest = 0;

  /** Keep what a request brings, unless a later one was made meanwhile. Answers that; null where it failed. */
  async load(request: Promise<Answer<Value>>): Promise<Value | null> {
    const loading = this.#newest + 1;
    const value = await this.ask(request);
    if (value !== null && loading === this.#newest) this.value = value;
    return value;
  }

  /** As `load`, and nothing is kept. */
  async ask<T>(request: Promise<Answer<T>>): Promise<T | null> {
    const answer = await this.#follow(request);
    return 'value' in answer ? answer.value : null;
  }

  /** Have a command done. Answers whether it was. */
  async run(command: Promise<string | Refusal | null>): Promise<boolean> {
    return 'value' in (await this.#follow(command.then((problem) => (problem === null ? { value: null } : typeof problem === 'string' ? { problem } : problem))));
  }

  /** What failed is of no interest any more. */
  forget(): void {
    this.problem = '';
    this.changed = false;
  }

  async #follow<T>(request: Promise<Answer<T>>): Promise<Answer<T>> {
    this.#newest += 1;
    const mine = this.#newest;
    this.busy = true;
    const answer = await request;
    if (mine === this.#newest) {
      this.busy = false;
      this.problem = 'problem' in answer ? answer.problem : '';
      this.changed = 'problem' in answer && answer.kind === 'changed';
    }
    return answer;
  }
}
