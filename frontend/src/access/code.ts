import { changedSeen, readSeen, writeSeen } from '../address';
import { access as texts } from '../texts/access';

/** The code that a link carries after its hash, where no server and no log ever sees it; null where there is none. */
export function codeIn(hash: string): string | null {
  const code = new URLSearchParams(hash.replace(/^#/, '')).get('pair');
  return code === null || code === '' ? null : code;
}

/** Take the code out of the address bar and the history, so that nobody reads it there. Returns it. */
export function takeCode(): string | null {
  const code = codeIn(location.hash);
  if (code !== null) history.replaceState(history.state, '', location.pathname + location.search);
  return code;
}

/** The token of a reading link, which stands in what the address says is seen: #/sessions/3?at=12.5&read=…; null where there is none. */
export function readingIn(hash: string): string | null {
  const token = new URLSearchParams(hash.replace(/^[^?]*/s, '')).get('read');
  return token === null || token === '' ? null : token;
}

/** Take the token of a reading link out of the address, which stays as it is otherwise. Returns it. */
export function takeReading(): string | null {
  const token = readingIn(location.hash);
  if (token === null) return null;
  const [path = '', seen = ''] = location.hash.split(/\?(.*)/s);
  const rest = writeSeen(changedSeen(readSeen(seen), { read: null }));
  history.replaceState(history.state, '', rest === '' ? path : `${path}?${rest}`);
  return token;
}

const BROWSERS = [
  ['Edg/', 'Edge'],
  ['OPR/', 'Opera'],
  ['Firefox/', 'Firefox'],
  ['Chrome/', 'Chrome'],
  ['Safari/', 'Safari'],
] as const;
const SYSTEMS = [
  ['iPhone', 'iPhone'],
  ['iPad', 'iPad'],
  ['Android', 'Android'],
  ['Windows', 'Windows'],
  ['Macintosh', 'Mac'],
  ['Linux', 'Linux'],
] as const;

/** A name for a browser, by what it says of itself: people tell their devices apart by it. */
export function browserName(agent: string): string {
  const found = (all: readonly (readonly [string, string])[]) => all.find(([mark]) => agent.includes(mark))?.[1];
  const browser = found(BROWSERS) ?? texts.browser;
  const system = found(SYSTEMS);
  return system === undefined ? browser : texts.browserOn(browser, system);
}
