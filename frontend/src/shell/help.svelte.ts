import { createContext } from 'svelte';

/** The drawer with a chapter of the help. It comes after the page's first view; where it cannot, the help opens in a tab. */
export class HelpDrawer {
  /** of the chapter; null while the drawer is closed */
  address = $state<string | null>(null);
  #missing = false;
  #opener: Pick<HTMLElement, 'focus'> | null = null;

  /** @param fetched null where the drawer could not be fetched */
  constructor(fetched: Promise<object | null>) {
    void fetched.then((found) => (this.#missing = found === null));
  }

  /** Open a chapter, or close the drawer where it shows this one. Returns false where there is no drawer. */
  toggle(address: string, opener: Pick<HTMLElement, 'focus'>): boolean {
    if (this.#missing) return false;
    if (this.address === address) {
      this.close();
    } else {
      this.#opener = opener;
      this.address = address;
    }
    return true;
  }

  /** Close it; the focus goes back to what has opened it. */
  readonly close = (): void => {
    this.address = null;
    this.#opener?.focus();
  };
}

export const [useHelp, provideHelp] = createContext<HelpDrawer>();
