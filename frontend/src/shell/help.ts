import type { PageName } from '../router.svelte';

/** The chapter of the help for each page. A key with a slash is a view within the page. */
const CHAPTERS: Readonly<Partial<Record<string, string>>> & Readonly<Record<PageName, string>> = {
  operate: 'use/operate/',
  flight: 'use/fly/',
  exhibit: 'use/exhibit/',
  tune: 'use/tune/',
  'tune/parameters': 'use/tune/#change-parameters',
  'tune/craft': 'use/identify/',
  'tune/vision': 'use/vision/',
  missions: 'use/missions/',
  scenarios: 'use/scenarios/',
  'scenarios/sweeps': 'use/sweeps/',
  'comm-tests': 'use/comm-tests/',
  sessions: 'use/sessions/',
  'sessions/compare': 'use/compare/',
  gamepads: 'use/operate/#gamepads',
  replay: 'use/sessions/#replay',
  robots: 'run/roster/',
  figures: 'run/lab/#figures',
  system: 'run/troubleshoot/',
  people: 'run/access/',
  'bring-up': 'run/bring-up/',
  unknown: '',
};

/** The address of the help for what is shown. */
export function helpAddress(page: PageName, within: readonly string[]): string {
  return `/help/${CHAPTERS[`${page}/${within[0] ?? ''}`] ?? CHAPTERS[page]}`;
}
