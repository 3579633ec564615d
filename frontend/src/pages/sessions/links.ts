/** Addresses within the page. */

export const OVERVIEW = '#/sessions';
export const sessionLink = (id: number): string => `${OVERVIEW}/${id}`;
export const compareLink = (ids: readonly number[]): string => `${OVERVIEW}/compare/${ids.join(',')}`;
/** the dashboard as it was; `at` is in s since the session's start */
export const replayLink = (id: number, at?: number): string =>
  at === undefined ? `#/replay/${id}` : `#/replay/${id}/${Math.max(0, at).toFixed(1)}`;
