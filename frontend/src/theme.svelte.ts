import { createContext } from 'svelte';

const KEY = 'mucat-theme';
const GROUND = { dark: '#0a1117', sunlight: '#f4f7f9' } as const;

/** The page's colours: dark, or light enough for sunlight; remembered on this device. */
export class Theme {
  current = $state<keyof typeof GROUND>('dark');

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
    document.querySelector('meta[name=theme-color]')?.setAttribute('content', GROUND[this.current]);
  }
}

export const [useTheme, provideTheme] = createContext<Theme>();

/** The value of a token of styles/tokens.css as it stands. */
export function token(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
