/** Addresses within the page. */

export const OVERVIEW = '#/comm-tests';
export const runLink = (id: number): string => `${OVERVIEW}/runs/${id}`;
export const compareLink = (ids: readonly (number | string)[]): string => `${OVERVIEW}/compare/${ids.join('/')}`;
