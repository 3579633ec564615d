import { createContext } from 'svelte';

export const PAGES = [
  { name: 'operate', title: 'Operate' },
  { name: 'sessions', title: 'Sessions' },
  { name: 'system', title: 'System' },
] as const;

export type PageName = (typeof PAGES)[number]['name'];

/** The page that the address names after its hash; Operate where it names none. */
export class Router {
  current = $state<PageName>('operate');

  constructor() {
    const read = () => {
      const name = location.hash.replace(/^#\/?/, '');
      this.current = PAGES.find((page) => page.name === name)?.name ?? 'operate';
    };
    window.addEventListener('hashchange', read);
    read();
  }
}

export const [useRouter, provideRouter] = createContext<Router>();
