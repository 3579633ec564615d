import { createContext } from 'svelte';

/** The search for pages, sessions, actions and help, and the list of keys: which of them is open. */
export class FinderState {
  shown = $state<'find' | 'keys' | null>(null);
  /** what is searched for */
  typed = $state('');
  /** whether what is shown takes the keys: it is fetched when it is opened first */
  ready = false;

  /** Take in a key that is typed before the search is there. Returns whether it was one: it is then no shortcut. */
  takes(event: KeyboardEvent): boolean {
    if (this.shown !== 'find' || this.ready || event.ctrlKey || event.metaKey || event.altKey) return false;
    if (event.key.length === 1) this.typed += event.key;
    return event.key.length === 1 || event.key === 'Enter';
  }
}

export const [useFinder, provideFinder] = createContext<FinderState>();
