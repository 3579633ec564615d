import { createContext } from 'svelte';

export const PAGES = [
  { name: 'operate', title: 'Operate' },
  { name: 'tune', title: 'Tune' },
  { name: 'scenarios', title: 'Scenarios' },
  { name: 'comm-tests', title: 'Comm tests' },
  { name: 'sessions', title: 'Sessions' },
  { name: 'system', title: 'System' },
] as const;

/** Pages that are reached from others. */
const INNER = [
  { name: 'replay', title: 'Replay' },
  { name: 'people', title: 'People' },
] as const;
const ALL = [...PAGES, ...INNER];

export type PageName = (typeof ALL)[number]['name'] | 'unknown';

/** The page that the address names after its hash: Operate where it names none, `unknown` where there is no such page. */
export class Router {
  current = $state<PageName>('operate');
  /** what the address names within the page: #/comm-tests/runs/3 is ['runs', '3'] */
  within = $state.raw<readonly string[]>([]);

  constructor() {
    const read = () => {
      const [name = '', ...within] = location.hash.replace(/^#\/?/, '').split('/');
      this.current = name === '' ? 'operate' : (ALL.find((page) => page.name === name)?.name ?? 'unknown');
      this.within = within;
    };
    window.addEventListener('hashchange', read);
    read();
  }

  get title(): string {
    return ALL.find((page) => page.name === this.current)?.title ?? 'Not found';
  }
}

export const [useRouter, provideRouter] = createContext<Router>();
