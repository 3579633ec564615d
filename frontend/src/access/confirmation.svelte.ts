import { api } from '../api';
import { codeIn } from './code';

/** A confirmation that the server asks for before a dangerous act. */
export class Confirmation {
  /** whether the dialog is open */
  open = $state(false);
  /** why the last code did not confirm, in words */
  problem = $state('');
  #waiting: ((confirmed: boolean) => void)[] = [];

  /** Open the dialog. Answers whether a code has confirmed; several acts wait for the same one. */
  ask(): Promise<boolean> {
    this.open = true;
    return new Promise((resolve) => this.#waiting.push(resolve));
  }

  /** Send a code, or the link that ends with it. Answers whether it confirms. */
  async use(typed: string): Promise<boolean> {
    const code = typed.includes('#') ? codeIn(typed.slice(typed.indexOf('#'))) : typed;
    const problem = await api.confirm(code ?? typed);
    if (problem === null) this.#close(true);
    else this.problem = problem;
    return problem === null;
  }

  cancel(): void {
    this.#close(false);
  }

  #close(confirmed: boolean): void {
    this.open = false;
    this.problem = '';
    for (const answer of this.#waiting.splice(0)) answer(confirmed);
  }
}
