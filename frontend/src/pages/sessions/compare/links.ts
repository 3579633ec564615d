/** Addresses within the page. */

export const SESSIONS = '#/sessions';
export const compareLink = (ids: readonly number[]): string => `${SESSIONS}/compare/${ids.join(',')}`;

/** The sessions that an address like 7,9 names; what is no number is passed over. */
export function readIds(text: string): number[] {
  const ids = text.split(',').map(Number);
  return [...new Set(ids.filter((id) => Number.isSafeInteger(id) && id > 0))];
}
