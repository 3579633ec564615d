import { createContext } from 'svelte';
import { api, type Identity, type CallerDetails } from '../api';
import type { operations } from '../generated/api';
import { NO_ANSWER, onSignedOut, onUnconfirmed } from '../http';
import { keepSecret } from '../pageSecret';
import { access as texts } from '../texts/access';
import { Confirmation } from './confirmation.svelte';

/** what the server can be asked for, by the names in its interface */
export type Operation = keyof operations;

/** ms between two looks while the server does not answer */
const LOOK_AGAIN = 2000;
const pause = () => new Promise((resolve) => setTimeout(resolve, LOOK_AGAIN));

/** Identity and rights of this page's user. */
export class Access {
  /** `unknown` until the server has said it, so that nobody sees the sign-in in passing */
  state = $state<'unknown' | 'out' | 'in'>('unknown');
  identity = $state.raw<Identity | null>(null);
  robot = $state('');
  /** true where the server is a lab's, which has no robot */
  lab = $state(false);
  /** why somebody who was signed in is so no longer, or why a code did not sign in */
  reason = $state('');
  /** the code of the link that was followed, until it is used; '' where there is none */
  offered = $state('');
  /** when the reading link ends that lets this page in, s since 1970; null without one */
  ends = $state<number | null>(null);
  /** the server has not answered so far */
  silent = $state(false);
  readonly confirmation = new Confirmation();
  #operatorsOnly: readonly string[] = [];

  constructor() {
    onSignedOut((why) => this.leave(why));
    onUnconfirmed(() => this.confirmation.ask());
  }

  /** the one session that a reading link shows; null for everybody else */
  get reads(): number | null {
    return this.identity?.session ?? null;
  }

  /**
   * Find out who this is, and use the code of a link where it gives more rights. Who is not signed in is asked for a name
   * first, or let in by the token of a reading link.
   */
  async open(code: string | null, name: string, reading: string | null = null): Promise<void> {
    let me = await this.#ask();
    while (me === null) {
      await pause();
      me = await this.#ask();
    }
    if (reading !== null && me.identity?.session !== null) {
      await this.#read(reading);
      return;
    }
    if (me.identity === null) this.offered = code ?? '';
    const raises = code !== null && me.identity?.role === 'viewer';
    if (raises && (await this.pair(code, name)) === null) return;
    this.#take(me);
  }

  async #read(token: string): Promise<void> {
    let answer = await api.openReadingLink(token);
    while ('problem' in answer && answer.kind === NO_ANSWER) {
      this.silent = true;
      await pause();
      answer = await api.openReadingLink(token);
    }
    this.silent = false;
    if ('problem' in answer) {
      // The link of before, if there was one, is not what somebody wants to read by now.
      this.state = 'out';
      this.identity = null;
      this.reason = answer.problem;
      return;
    }
    if (answer.value.page_secret !== null) keepSecret(answer.value.page_secret);
    this.reason = '';
    this.#take(answer.value);
  }

  /** Find out whether this page is signed in still; `reason` is why it may not be. Returns whether the server says so. */
  async check(reason: string): Promise<boolean> {
    const me = await this.#ask();
    if (me === null) return false;
    if (me.signed_in) this.#take(me);
    else this.leave(reason || me.ended || texts.noLongerSignedIn);
    return me.signed_in;
  }

  /** Use a code. Returns what went wrong, or null. */
  async pair(code: string, name: string): Promise<string | null> {
    const answer = await api.pair(code, name);
    this.offered = '';
    this.reason = 'problem' in answer ? answer.problem : '';
    if ('problem' in answer) return answer.problem;
    if (answer.value.page_secret !== null) keepSecret(answer.value.page_secret);
    this.#take(answer.value);
    return null;
  }

  async signOut(): Promise<string | null> {
    const problem = await api.signOut();
    if (problem !== null) return problem;
    this.leave('');
    this.reason = texts.signedOut;
    return null;
  }

  /** This page is not signed in any more. */
  leave(reason: string): void {
    if (this.state !== 'in') return;
    this.confirmation.cancel();
    this.state = 'out';
    this.identity = null;
    this.reason = reason;
  }

  /** The robot has said anew who this is. */
  know(identity: Pick<Identity, 'name' | 'role'>): void {
    if (this.identity !== null) this.identity = { ...this.identity, ...identity };
  }

  async #ask(): Promise<CallerDetails | null> {
    const answer = await api.me();
    this.silent = 'problem' in answer;
    return 'value' in answer ? answer.value : null;
  }

  /** Why this is not for who uses this page, in words; null where it is. What needs control says so by itself. */
  refusal(operation: Operation): string | null {
    if (this.identity?.role !== 'viewer' || !this.#operatorsOnly.includes(operation)) return null;
    return this.reads === null ? texts.operatorOnly : texts.readerOnly;
  }

  #take(me: CallerDetails): void {
    this.#operatorsOnly = me.operators_only;
    this.robot = me.robot;
    this.lab = me.lab;
    this.identity = me.identity;
    this.ends = me.ends;
    if (this.reason === '') this.reason = me.ended;
    this.state = me.signed_in ? 'in' : 'out';
  }
}

export const [useAccess, provideAccess] = createContext<Access>();
