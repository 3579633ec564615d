/** Has an action repeated while a button is held, and ended once it is released. */

/** what goes with the first post, those after it, and the last */
const FIRST = {};
const AGAIN = { on: 1 };
const LAST = { stop: 1 };

export class Hold {
  #held = false;
  #running = false;

  /**
   * @param post answers whether it was accepted; what is refused is not repeated
   * @param every ms between two posts. One follows the other: a late one must not come after the last
   * @param ended called where a refusal has ended it
   */
  constructor(
    private readonly post: (inputs: Record<string, number>) => Promise<boolean>,
    private readonly every: number,
    private readonly ended: () => void,
  ) {}

  begin(): void {
    this.#held = true;
    if (!this.#running) void this.#run();
  }

  release(): void {
    this.#held = false;
  }

  async #run(): Promise<void> {
    const held = () => this.#held;
    this.#running = true;
    while (held()) {
      let inputs: Record<string, number> = FIRST;
      while (held()) {
        const pause = new Promise((resolve) => setTimeout(resolve, this.every));
        if (!(await this.post(inputs))) {
          this.release();
          this.ended();
        }
        inputs = AGAIN;
        if (held()) await pause;
      }
      await this.post(LAST);
    }
    this.#running = false;
  }
}
