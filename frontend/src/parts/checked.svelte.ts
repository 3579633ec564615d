import { count } from '../format';
import type { Answer } from '../http';
import { useLive } from '../live/live.svelte';
import { parts } from '../texts/parts';
import type { Draft } from './draft';

/** ms without a change after which the server is asked */
const PAUSE = 250;
/** ms after a check without an answer, or refused for now, until the next */
const AGAIN = 2000;
/** characters of a text: the server reads no longer one (`BYTES_MAX` of robot_runtime/contract/toml_text.py) */
const MOST = 60_000;

/** A document that somebody writes, and what the server says to it. To be made while a component begins. */
export class CheckedText<Check extends { readonly problems: readonly unknown[] }> {
  /** the last answer; null before the first */
  check = $state.raw<Check | null>(null);
  /** the text that `check` is about */
  checked = $state('');
  /** why it could not be checked */
  problem = $state('');
  readonly #draft: Draft;
  #text = $state('');
  /** whether there has been a text: one that is emptied is checked, too */
  #begun = $state(false);

  constructor(draft: Draft, ask: (text: string) => Promise<Answer<Check>>) {
    this.#draft = draft;
    this.#text = draft.read();
    this.#begun = this.#text !== '';
    const live = useLive();
    $effect(() => {
      // What could not be checked while the server was away is checked when it is back.
      if (!this.#begun || live.connection !== 'open') return undefined;
      const asked = this.#text;
      if (asked.length > MOST) {
        this.problem = parts.code.tooLong(count(asked.length), count(MOST));
        return undefined;
      }
      let outdated = false;
      const look = async () => {
        const answer = await ask(asked);
        if (outdated) return;
        this.problem = 'problem' in answer ? answer.problem : '';
        if ('problem' in answer) {
          timer = setTimeout(() => void look(), AGAIN);
          return;
        }
        this.check = answer.value;
        this.checked = asked;
      };
      let timer = setTimeout(() => void look(), PAUSE);
      return () => {
        outdated = true;
        clearTimeout(timer);
      };
    });
  }

  get text(): string {
    return this.#text;
  }

  set text(next: string) {
    this.#text = next;
    if (next !== '') this.#begun = true;
    this.#draft.write(next);
  }

  /** whether `check` is about the text as it stands */
  get current(): boolean {
    return this.check !== null && this.checked === this.#text;
  }

  get sound(): boolean {
    return this.current && this.check?.problems.length === 0;
  }
}
