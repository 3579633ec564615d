import { shell } from '../texts/shell';

/** The page's heading names the document, and gets the focus where another page is there and nothing else has got it. */
export class Heading {
  #current: HTMLElement | null = null;
  /** what had the focus when the page was left */
  #focusBefore: Element | null = null;
  readonly #appearing = new MutationObserver(() => this.#find());
  readonly #changing = new MutationObserver(() => this.#name());

  constructor(private readonly place: HTMLElement) {}

  /**
   * Follow a navigation.
   *
   * @param title the document's, until the heading is there
   */
  follow(title: string): void {
    this.end();
    document.title = shell.titleOf(title);
    this.#focusBefore = document.activeElement;
    // Until it is there: the page of a robot at work changes all the time.
    this.#appearing.observe(this.place, { childList: true, subtree: true });
    this.#find();
  }

  end(): void {
    this.#appearing.disconnect();
    this.#changing.disconnect();
  }

  #find(): void {
    const found = this.place.querySelector('h1');
    if (found === null) return;
    this.#appearing.disconnect();
    this.#changing.observe(found, { childList: true, characterData: true, subtree: true });
    const { activeElement } = document;
    const still = activeElement === document.body || activeElement === this.#focusBefore;
    if (found !== this.#current && this.#current !== null && still) {
      found.tabIndex = -1;
      found.focus();
    }
    this.#current = found;
    this.#name();
  }

  #name(): void {
    const text = this.#current?.textContent.replaceAll(/\s+/g, ' ').trim() ?? '';
    if (text !== '') document.title = shell.titleOf(text);
  }
}
