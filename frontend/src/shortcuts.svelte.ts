import { createContext } from 'svelte';
import { readStored, writeStored } from './storage';

const KEY = 'mucat-shortcuts';
const TYPED = 'input:not([type="range"], [type="checkbox"], [type="radio"]), textarea, select, [contenteditable], [data-typed]';

/** True where a key that goes down at `target` is typed into a field, or chooses in one. */
export const isTyping = (target: EventTarget | null): boolean => target instanceof Element && target.closest(TYPED) !== null;

/** The letters of single keys that work on every page, by what they do. */
export const LETTERS = { flight: ['f', 'v'], bookmark: ['m'], snapshot: ['p'], keys: ['?'] } as const;

/** Switch of the single keys that mark and drive (WCAG 2.1.4); remembered on this device. Esc is STOP in any case. */
export class Shortcuts {
  on = $state(readStored(KEY) !== 'off');

  readonly set = (on: boolean): void => {
    this.on = on;
    writeStored(KEY, on ? 'on' : 'off');
  };

  /** True where one of these letters goes down alone, as a shortcut. */
  pressed(event: KeyboardEvent, ...letters: readonly string[]): boolean {
    if (!letters.includes(event.key.toLowerCase()) || event.repeat || event.ctrlKey || event.metaKey || event.altKey) return false;
    return this.on && !isTyping(event.target);
  }
}

export const [useShortcuts, provideShortcuts] = createContext<Shortcuts>();
