import { createContext } from 'svelte';

/** The drawer with a chapter of the help. While it is not loaded, the help opens in a tab. */
export class HelpDrawer {
  /** of the chapter; null while the drawer is closed */
  address = $state<string | null>(null);
  loaded = false;
  #opener: HTMLElement | null = null;

  /** Open a chapter, or close the drawer where it shows this one. Returns false where there is no drawer. */
  toggle(address: string, opener: HTMLElement): boolean {
    if (!this.loaded) return false;
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
