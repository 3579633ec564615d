import { SvelteMap } from 'svelte/reactivity';
import { api, type LoopName, type TuningRun, type TuningRunDetail, type TuningRuns } from '../../../api';
import type { Router } from '../../../router.svelte';

/** as many as there are colours */
const MOST_SHOWN = 7;
const NAME = 'runs';

/** The stored runs on one loop, and which of them are laid over each other: the address names them. */
export class KeptRuns {
  list = $state.raw<TuningRuns | null>(null);
  problem = $state('');
  readonly #whole = new SvelteMap<number, TuningRunDetail>();

  constructor(
    private readonly router: Router,
    private readonly loop: () => LoopName,
  ) {}

  readonly runs: readonly TuningRun[] = $derived.by(() => (this.list?.runs ?? []).filter((run) => run.state !== 'running'));

  /** The numbers of the shown runs, the chosen one last. Without any in the address, it is the newest that is complete. */
  readonly ids: readonly number[] = $derived.by(() => {
    const named = this.router.seen.get(NAME);
    if (named === undefined) {
      const newest = this.runs.find((run) => run.kind === 'step' && run.state === 'complete') ?? this.runs.find((run) => run.state === 'complete');
      return newest ? [newest.id] : [];
    }
    const ids = named.split(',').map(Number);
    return ids.filter((id, place) => ids.indexOf(id) === place && this.runs.some((run) => run.id === id)).slice(-MOST_SHOWN);
  });

  /** those whose curves have come, the oldest first, so that each keeps its place */
  readonly shown: readonly TuningRunDetail[] = $derived.by(() =>
    [...this.ids]
      .sort((one, other) => one - other)
      .flatMap((id) => {
        const whole = this.#whole.get(id);
        return whole ? [whole] : [];
      }),
  );

  /** whose figures are drawn on its curve */
  readonly chosen: TuningRunDetail | null = $derived.by(() => this.#whole.get(this.ids.at(-1) ?? NaN) ?? null);

  async load(): Promise<void> {
    const asked = this.loop();
    const answer = await api.tuningRuns(asked);
    if (asked !== this.loop()) return;
    this.problem = 'problem' in answer ? answer.problem : '';
    if ('value' in answer) this.list = answer.value;
  }

  /** Lay a run over the shown ones of its kind, as the chosen one; a relay stands alone. */
  show(id: number): void {
    const run = this.runs.find((one) => one.id === id);
    if (run === undefined) return;
    const others = run.kind === 'relay' ? [] : this.ids.filter((one) => one !== id && this.runs.find((other) => other.id === one)?.kind === 'step');
    this.#see([...others, id].slice(-MOST_SHOWN));
  }

  hide(id: number): void {
    this.#see(this.ids.filter((one) => one !== id));
  }

  async rename(id: number, name: string): Promise<string | null> {
    const problem = await api.renameTuning(id, name);
    this.#whole.delete(id);
    await this.load();
    await this.fetch();
    return problem;
  }

  async remove(id: number): Promise<string | null> {
    const problem = await api.deleteTuning(id);
    await this.load();
    return problem;
  }

  /** Fetch the curves of the shown runs that are not there yet. */
  async fetch(): Promise<void> {
    await Promise.all(
      this.ids
        .filter((id) => !this.#whole.has(id))
        .map(async (id) => {
          const answer = await api.tuningRun(id);
          if ('value' in answer) this.#whole.set(id, answer.value);
          else this.problem = answer.problem;
        }),
    );
  }

  #see(ids: readonly number[]): void {
    this.router.show({ [NAME]: ids.join(',') });
  }
}
