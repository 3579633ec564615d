/** When a reading link ends: from now on, or with a day of this device's calendar. */
export type LinkEnd = 'day' | 'week' | 'date';

const DAY = 86_400;

/**
 * The end of a link, s since 1970; null where no day was chosen, or one that is over.
 *
 * @param date as a date field gives it: 2026-11-29
 * @param now ms since 1970
 */
export function linkEnd(end: LinkEnd, date: string, now: number): number | null {
  if (end !== 'date') return now / 1000 + (end === 'day' ? 1 : 7) * DAY;
  const last = new Date(`${date}T23:59:59`).getTime();
  return last > now ? last / 1000 : null;
}

/** The address of what is seen, with the token of a reading link after the hash, where no server sees it. */
export function readingAddress(address: string, token: string): string {
  return `${address}${address.includes('?', address.indexOf('#')) ? '&' : '?'}read=${token}`;
}
