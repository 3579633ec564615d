import { createContext } from 'svelte';

const KEY = 'mucat-theme';

/** The page's colours: dark, or light enough for sunlight; remembered on this device. */
export class Theme {
  current = $state<'dark' | 'sunlight'>('dark');

  constructor() {
    try {
      if (localStorage.getItem(KEY) === 'sunlight') this.current = 'sunlight';
    } catch {
      // Storage may be forbidden; then the choice lasts as long as the page.
    }
    this.#show();
  }

  readonly toggle = (): void => {
    this.current = this.current === 'dark' ? 'sunlight' : 'dark';
    this.#show();
    try {
      localStorage.setItem(KEY, this.current);
    } catch {
      // As above.
    }
  };

  #show(): void {
    document.documentElement.dataset.theme = this.current;
    document.querySelector('meta[name=theme-color]')?.setAttribute('content', token('ground'));
  }
}

export const [useTheme, provideTheme] = createContext<Theme>();

/** The value of a token of styles/tokens.css as it stands. */
export function token(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** A canvas font: a size of the type scale in the page's typeface. */
export const canvasFont = (size: 'tiny' | 'small'): string => `${token(size)} ${token('font')}`;
