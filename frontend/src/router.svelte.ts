import { createContext } from 'svelte';
import { changedSeen, readSeen, writeSeen, type Seen } from './address';
import { pages } from './texts/pages';

/** The pages that have a tab. */
export const PAGES = ['operate', 'tune', 'missions', 'scenarios', 'comm-tests', 'sessions', 'system'] as const;
/** The pages of a lab that have a tab. */
const LAB_PAGES = ['robots', 'scenarios', 'sessions', 'figures', 'system'] as const;
/** The pages of a lab without a tab. */
const LAB_INNER: readonly PageName[] = ['replay', 'exhibit', 'people'];
type Tab = (typeof PAGES | typeof LAB_PAGES)[number];
const ALL = [...PAGES, 'flight', 'exhibit', 'gamepads', 'replay', 'people', 'bring-up'] as const;

export type PageName = (typeof ALL)[number] | Tab | 'unknown';

/** ms between two writings of the address: browsers refuse many in a row */
const WRITE_AFTER = 300;

/** The page that the address names after its hash: the first where it names none, `unknown` where there is no such page. */
export class Router {
  current = $state<PageName>('operate');
  /** the pages that have a tab here */
  tabs = $state.raw<readonly [Tab, ...Tab[]]>(PAGES);
  /** what the address names within the page: #/comm-tests/runs/3 is ['runs', '3'] */
  within = $state.raw<readonly string[]>([]);
  /** what the address says of what is seen there: #/sessions/3?at=12.5 is at, '12.5'. Whoever reads it checks it. */
  seen = $state.raw<Seen>(readSeen(''));
  #path = '';
  #inner: readonly PageName[] = ALL;
  /** the address as it was read or written here last */
  #known = '';
  #writing: ReturnType<typeof setTimeout> | undefined;
  /** when it was written here last, ms */
  #written = -Infinity;

  constructor() {
    window.addEventListener('hashchange', this.#read);
    this.#read();
  }

  /** Know the pages of a lab alone, which has no robot. */
  enterLab(): void {
    this.tabs = LAB_PAGES;
    this.#inner = LAB_INNER;
    this.#read();
  }

  /** Go to what this address names, also where one is there already. */
  open(hash: string): void {
    location.hash = hash;
    this.#read();
  }

  get title(): string {
    return pages[this.current];
  }

  /** the whole address of what is seen, to be given to others */
  get address(): string {
    return location.href.replace(/#.*/s, '') + this.#hash();
  }

  /**
   * Put what is seen into the address. The names that are not given stay, and null takes one out.
   *
   * @param step true: "back" returns to what was seen before
   */
  show(changes: Readonly<Record<string, string | number | null>>, step = false): void {
    const before = this.#hash();
    this.seen = changedSeen(this.seen, changes);
    if (this.#hash() === before) return;
    clearTimeout(this.#writing);
    if (!step) {
      // At once where it rested: whoever reloads then sees the same.
      const wait = this.#written + WRITE_AFTER - performance.now();
      if (wait <= 0) this.#write('replaceState', this.#hash());
      else this.#writing = setTimeout(() => this.#write('replaceState', this.#hash()), wait);
      return;
    }
    // What was still to be written belongs to the step before.
    this.#write('replaceState', before);
    this.#write('pushState', this.#hash());
  }

  /** The number of this name in the address, or null where it has none that lies within the limits. */
  number(name: string, least = -Infinity, most = Infinity): number | null {
    const text = this.seen.get(name) ?? '';
    const value = Number(text);
    return text.trim() === '' || !Number.isFinite(value) || value < least || value > most ? null : value;
  }

  readonly #read = (): void => {
    clearTimeout(this.#writing);
    this.#known = location.hash;
    const [path = '', seen = ''] = location.hash.replace(/^#\/?/, '').split(/\?(.*)/s);
    this.#path = path;
    const [name = '', ...within] = path.split('/');
    this.current = name === '' ? this.tabs[0] : ([...this.tabs, ...this.#inner].find((page) => page === name) ?? 'unknown');
    this.within = within;
    this.seen = readSeen(seen);
  };

  #hash(): string {
    const seen = writeSeen(this.seen);
    return `#/${this.#path}${seen === '' ? '' : `?${seen}`}`;
  }

  #write(how: 'pushState' | 'replaceState', hash: string): void {
    // One that was just changed, and that nobody has told of yet, is where somebody wants to go.
    if (location.hash !== this.#known) return;
    history[how](history.state, '', hash);
    this.#written = performance.now();
    this.#known = location.hash;
  }
}

export const [useRouter, provideRouter] = createContext<Router>();

/** Remember the address. The answer says later whether it is the same page: whoever has gone on is not taken back. */
export function rememberAddress(): () => boolean {
  const path = () => location.hash.replace(/\?.*/s, '');
  const before = path();
  return () => path() === before;
}
