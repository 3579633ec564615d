import { api, type HandsOrder, type BringUpInputs, type BringUpState } from '../../api';
import type { Answer } from '../../http';

/** ms between two looks: of live readings, while something is being done, and while nothing is */
const EVERY: Readonly<Record<BringUpState['phase'], number>> = { ready: 250, starting: 500, ending: 500, idle: 2000 };

/** The bring-up as the server tells it. */
export class BringUpWatch {
  state = $state.raw<BringUpState | null>(null);
  /** why it could not be looked at */
  problem = $state('');
  /** counts what the server has done meanwhile: an answer from before is older */
  #turn = 0;

  /** ms between two looks as things are */
  get pause(): number {
    return EVERY[this.state?.phase ?? 'idle'];
  }

  /** the bring-up that this page shows */
  get #run(): BringUpState['run'] {
    return this.state?.run ?? '';
  }

  async look(): Promise<void> {
    const turn = this.#turn;
    const answer = await api.bringUp();
    if (turn !== this.#turn) return;
    this.problem = 'problem' in answer ? answer.problem : '';
    if ('value' in answer) this.state = answer.value;
  }

  begin = (): Promise<string | null> => this.#change(api.beginBringUp());
  end = (): Promise<string | null> => this.#change(api.endBringUp(this.#run));
  useHands = (order: HandsOrder): Promise<string | null> => this.#change(api.useHandsInBringUp(order));
  act = (step: string, action: string, inputs: BringUpInputs): Promise<string | null> => this.#change(api.actInBringUp(this.#run, step, action, inputs));

  /** Answers why it was refused, in words; null where it was not. */
  async #change(request: Promise<Answer<BringUpState>>): Promise<string | null> {
    const answer = await request;
    this.#turn += 1;
    if ('problem' in answer) return answer.problem;
    this.state = answer.value;
    return null;
  }
}
