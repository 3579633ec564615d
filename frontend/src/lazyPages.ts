/** Pages that are fetched when they are first shown. */
import type { Component } from 'svelte';
import type { PageName, Router } from './router.svelte';

type Load = () => Promise<{ default: Component }>;

export const lazyPages = {
  flight: () => import('./flight/FlightView.svelte'),
  exhibit: () => import('./flight/Exhibit.svelte'),
  tune: () => import('./pages/tune/Tune.svelte'),
  missions: () => import('./pages/missions/Missions.svelte'),
  scenarios: () => import('./pages/scenarios/Scenarios.svelte'),
  'comm-tests': () => import('./pages/comm_tests/CommTests.svelte'),
  sessions: () => import('./pages/sessions/Sessions.svelte'),
  robots: () => import('./pages/robots/Robots.svelte'),
  figures: () => import('./pages/figures/ArchiveFigures.svelte'),
  gamepads: () => import('./pages/gamepads/Gamepads.svelte'),
  replay: () => import('./pages/replay/Replay.svelte'),
  people: () => import('./pages/people/People.svelte'),
  'bring-up': () => import('./pages/bring_up/BringUp.svelte'),
  unknown: () => import('./pages/not_found/NotFound.svelte'),
  system: () => import('./pages/system/System.svelte'),
} satisfies Partial<Record<PageName, Load>>;

/** What is not seen at first. Null where it cannot be fetched: the page works without. */
export const later = (): Promise<Component | null> => import('./shell/Later.svelte').then((loaded) => loaded.default, () => null);

/** Fetches the page that the address names, before it is known who asks; one that fails is fetched again when it is shown. */
export function prefetch({ current, within }: Router): void {
  const load = (lazyPages as Partial<Record<PageName, Load>>)[current];
  load?.().catch(() => undefined);
  if (current === 'sessions' && within[0] === 'compare') import('./pages/sessions/compare/CompareSessions.svelte').catch(() => undefined);
}
