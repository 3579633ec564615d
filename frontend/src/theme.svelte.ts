import { createContext } from 'svelte';
import { readStored, writeStored } from './storage';

const KEY = 'mucat-theme';

export const THEME_CHOICES = ['device', 'dark', 'sunlight'] as const;
type ThemeChoice = (typeof THEME_CHOICES)[number];

/** The page's colours: dark, or light enough for sunlight. The device's until one is chosen; remembered on it. */
export class Theme {
  choice = $state<ThemeChoice>('device');
  current = $state<'dark' | 'sunlight'>('dark');
  readonly #light = matchMedia('(prefers-color-scheme: light)');
  readonly #forced = matchMedia('(forced-colors: active)');

  constructor() {
    const stored = readStored(KEY);
    this.choice = THEME_CHOICES.find((one) => one === stored) ?? 'device';
    this.#light.addEventListener('change', this.#show);
    this.#forced.addEventListener('change', this.#show);
    this.#show();
  }

  choose(choice: ThemeChoice): void {
    this.choice = choice;
    this.#show();
    writeStored(KEY, choice);
  }

  // Forced colours have a ground of their own, which the device calls light or dark.
  readonly #show = (): void => {
    const ofDevice = this.#light.matches ? 'sunlight' : 'dark';
    this.current = this.choice === 'device' || this.#forced.matches ? ofDevice : this.choice;
    document.documentElement.dataset.theme = this.current;
    document.querySelector('meta[name=theme-color]')?.setAttribute('content', token('ground'));
  };
}

export const [useTheme, provideTheme] = createContext<Theme>();

/** The value of a token of styles/tokens.css as it stands there: over a picture some have others. */
export function token(name: string, at: Element = document.documentElement): string {
  return getComputedStyle(at).getPropertyValue(`--${name}`).trim();
}

/** A canvas font: a size of the type scale in the page's typeface. */
export const canvasFont = (size: 'tiny' | 'small' | 'label' | 'title'): string => `${token(size)} ${token('font')}`;
