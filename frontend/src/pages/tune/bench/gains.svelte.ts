import { api, type LoopName } from '../../../api';
import type { Gain, State } from '../../../generated/topics';
import { Edits } from '../../../parts/edits.svelte';

type Value = number | string;

/**
 * Controller and gains of a loop as the bench tries them: what is wanted, what is in force, and what was before.
 *
 * What is tried is in force; `keep` leaves it there, `back` returns to what was before the first try.
 */
export class TriedGains {
  /** parameters by name, as they were before the bench changed them; null where nothing is tried */
  before = $state.raw<Readonly<Record<string, Value>> | null>(null);
  readonly #state: () => State | null;
  readonly #loop: () => LoopName;
  readonly #choice: Edits<string>;
  readonly #tuned: Edits<number>;

  constructor(state: () => State | null, loop: () => LoopName) {
    this.#state = state;
    this.#loop = loop;
    const time = () => state()?.time ?? 0;
    this.#choice = new Edits<string>(() => ({ controller: this.#described?.controller ?? '' }), time);
    this.#tuned = new Edits<number>(() => Object.fromEntries(this.gains.map((gain) => [gain.name, gain.value])), time);
  }

  get #described() {
    return this.#state()?.loops.find(({ name }) => name === this.#loop());
  }

  get controllers() {
    return this.#described?.controllers ?? [];
  }

  get inForce(): string {
    return this.#choice.inForce.controller ?? '';
  }

  get controller(): string {
    return this.#choice.wanted.controller ?? '';
  }

  /** of the wanted controller */
  get gains(): readonly Gain[] {
    return this.controllers.find(({ name }) => name === this.controller)?.gains ?? [];
  }

  get wanted(): Readonly<Record<string, number>> {
    return this.#tuned.wanted;
  }

  get changed(): boolean {
    return this.#choice.changed('controller') || this.gains.some(({ name }) => this.#tuned.changed(name));
  }

  get valid(): boolean {
    return this.gains.every(({ name, minimum, maximum }) => {
      const value = this.wanted[name] ?? NaN;
      return value >= minimum && value <= maximum;
    });
  }

  differs(name: string): boolean {
    return this.#tuned.changed(name);
  }

  choose(controller: string): void {
    this.#choice.write('controller', controller);
    this.#tuned.reset();
  }

  write(name: string, value: number): void {
    this.#tuned.write(name, value);
  }

  /** Set the sliders to these gains of this controller. */
  propose(controller: string, gains: Readonly<Record<string, number>>): void {
    this.choose(controller);
    for (const [name, value] of Object.entries(gains)) this.#tuned.write(name, value);
  }

  discard(): void {
    this.#choice.reset();
    this.#tuned.reset();
  }

  /** Put what is wanted into force. Answers what went wrong, or null. */
  async try(): Promise<string | null> {
    if (!this.changed) return null;
    const loop = this.#loop();
    const [controller, gains] = [this.controller, { ...this.wanted }];
    const values: Record<string, Value> = { [`${loop}.controller`]: controller };
    const old: Record<string, Value> = { [`${loop}.controller`]: this.inForce };
    for (const { name, value } of this.gains) {
      const path = `${loop}.${controller}.${name}`;
      values[path] = gains[name] ?? value;
      old[path] = value;
    }
    const problem = await api.command('parameters', { values });
    if (problem !== null) return problem;
    this.#choice.taken({ controller });
    this.#tuned.taken(gains);
    this.before = { ...old, ...this.before };
    return null;
  }

  /** Keep what is wanted. Answers what went wrong, or null. */
  async keep(): Promise<string | null> {
    const problem = await this.try();
    if (problem === null) this.before = null;
    return problem;
  }

  /** Return to what was in force before. Answers what went wrong, or null. */
  async back(): Promise<string | null> {
    if (this.before !== null) {
      const problem = await api.command('parameters', { values: this.before });
      if (problem !== null) return problem;
      this.before = null;
    }
    this.discard();
    return null;
  }
}
