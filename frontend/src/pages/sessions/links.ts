/** Addresses within the page. */

export const OVERVIEW = '#/sessions';
/** what a session's page shows: the dive, its signals, or its data */
export const SESSION_VIEWS = ['dive', 'study', 'data'] as const;
export type SessionView = (typeof SESSION_VIEWS)[number];
export const sessionLink = (id: number, view: SessionView = 'dive'): string => `${OVERVIEW}/${id}${view === 'dive' ? '' : `/${view}`}`;
export const compareLink = (ids: readonly number[]): string => `${OVERVIEW}/compare/${ids.join(',')}`;
/** the dashboard as it was; `at` is in s since the session's start */
export const replayLink = (id: number, at?: number): string =>
  at === undefined ? `#/replay/${id}` : `#/replay/${id}?at=${Math.max(0, at).toFixed(1)}`;
