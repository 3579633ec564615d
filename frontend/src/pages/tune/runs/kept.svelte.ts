import { SvelteMap } from 'svelte/reactivity';
import { api, type LoopName, type TuningRunDetail, type TuningRuns } from '../../../api';

const MOST_SHOWN = 6;

/** The runs of one kind on one loop, and which of them are laid over each other. */
export class KeptRuns {
  loop: LoopName;
  list = $state.raw<TuningRuns | null>(null);
  problem = $state('');
  chosen = $state.raw<readonly number[]>([]);
  readonly #whole = new SvelteMap<number, TuningRunDetail>();

  constructor(
    private readonly kind: 'step' | 'relay',
    loop: LoopName,
  ) {
    this.loop = $state(loop);
  }

  /** The run where it is one of these, else null. */
  own<Run extends { readonly kind: string; readonly loop: string }>(run: Run | null | undefined): Run | null {
    return run?.kind === this.kind && run.loop === this.loop ? run : null;
  }

  get runs() {
    return (this.list?.runs ?? []).filter((run) => run.kind === this.kind && run.state !== 'running');
  }

  /** what is laid over each other, in the order in which it was chosen */
  get shown(): readonly TuningRunDetail[] {
    return this.chosen.flatMap((id) => {
      const whole = this.#whole.get(id);
      return whole ? [whole] : [];
    });
  }

  async load(): Promise<void> {
    const asked = this.loop;
    const answer = await api.tuningRuns(asked);
    if (asked !== this.loop) return;
    this.problem = 'problem' in answer ? answer.problem : '';
    if (!('value' in answer)) return;
    const first = this.list === null;
    this.list = answer.value;
    this.chosen = this.chosen.filter((id) => this.runs.some((run) => run.id === id));
    const newest = this.runs.find((run) => run.state === 'complete');
    if (first && newest) await this.show(newest.id);
  }

  choose(loop: LoopName): Promise<void> {
    this.loop = loop;
    this.list = null;
    this.chosen = [];
    return this.load();
  }

  /** Lay a run over those that are shown. */
  async show(id: number): Promise<void> {
    if (this.chosen.includes(id) || !this.#has(id)) return;
    this.chosen = [...this.chosen, id].slice(-MOST_SHOWN);
    await this.#fetch(id);
  }

  /** Show this one alone. */
  async only(id: number): Promise<void> {
    if (!this.#has(id)) return;
    this.chosen = [id];
    await this.#fetch(id);
  }

  hide(id: number): void {
    this.chosen = this.chosen.filter((one) => one !== id);
  }

  async rename(id: number, name: string): Promise<string | null> {
    const problem = await api.renameTuning(id, name);
    this.#whole.delete(id);
    await this.load();
    if (this.chosen.includes(id)) await this.#fetch(id);
    return problem;
  }

  async remove(id: number): Promise<string | null> {
    const problem = await api.deleteTuning(id);
    if (problem === null) this.hide(id);
    await this.load();
    return problem;
  }

  #has(id: number): boolean {
    return this.runs.some((run) => run.id === id);
  }

  async #fetch(id: number): Promise<void> {
    if (this.#whole.has(id)) return;
    const answer = await api.tuningRun(id);
    if ('value' in answer) this.#whole.set(id, answer.value);
    else this.problem = answer.problem;
  }
}
