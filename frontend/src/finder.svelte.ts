import { createContext } from 'svelte';

/** The search for pages, sessions, actions and help, and the list of keys: which of them is open. */
export class FinderState {
  shown = $state<'find' | 'keys' | null>(null);
}

export const [useFinder, provideFinder] = createContext<FinderState>();
