import { api, type PredictedStep, type PredictionQuery } from '../../../api';

/** The predicted response: one request at a time, and after it the newest of those that were wanted meanwhile. */
export class StepPrediction {
  /** null: none yet */
  value = $state.raw<PredictedStep | null>(null);
  problem = $state('');
  busy = $state(false);
  #next: PredictionQuery | null = null;

  /** Predict this one. */
  async ask(query: PredictionQuery): Promise<void> {
    this.#next = query;
    if (this.busy) return;
    this.busy = true;
    while (this.#next !== null) {
      const asked = this.#next;
      this.#next = null;
      const answer = await api.predictStep(asked);
      this.problem = 'problem' in answer ? answer.problem : '';
      this.value = 'value' in answer ? answer.value : null;
    }
    this.busy = false;
  }

  /** What was predicted holds no more. */
  forget(): void {
    this.#next = null;
    this.value = null;
    this.problem = '';
  }
}
