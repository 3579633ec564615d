import { createContext } from 'svelte';
import { pages } from './texts/pages';

/** The pages that have a tab. */
export const PAGES = ['operate', 'tune', 'missions', 'scenarios', 'comm-tests', 'sessions', 'system'] as const;
const ALL = [...PAGES, 'flight', 'gamepads', 'replay', 'people', 'bring-up'] as const;

export type PageName = (typeof ALL)[number] | 'unknown';

/** The page that the address names after its hash: Operate where it names none, `unknown` where there is no such page. */
export class Router {
  current = $state<PageName>('operate');
  /** what the address names within the page: #/comm-tests/runs/3 is ['runs', '3'] */
  within = $state.raw<readonly string[]>([]);

  constructor() {
    const read = () => {
      const [name = '', ...within] = location.hash.replace(/^#\/?/, '').split('/');
      this.current = name === '' ? 'operate' : (ALL.find((page) => page === name) ?? 'unknown');
      this.within = within;
    };
    window.addEventListener('hashchange', read);
    read();
  }

  get title(): string {
    return pages[this.current];
  }
}

export const [useRouter, provideRouter] = createContext<Router>();

/** Remember the address. The answer says later whether it is the same: whoever has gone on is not taken back. */
export function rememberAddress(): () => boolean {
  const { hash } = location;
  return () => location.hash === hash;
}
