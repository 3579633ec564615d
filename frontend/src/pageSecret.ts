/**
 * The page's part of the sign-in: a secret that only pages of this address can read. Browsers send the cookie, the
 * other part, to every server of this host name, whatever its port.
 */
import { readStored, writeStored } from './storage';

const KEY = 'mucat.page_secret';
/** the subprotocol of the live socket; the secret is offered as a second one, since a page can give a socket no header */
const PROTOCOL = 'mucat';

/** it lasts as long as the page where the browser stores nothing */
let unstored = '';

export function keepSecret(secret: string): void {
  unstored = secret;
  writeStored(KEY, secret);
}

/** Headers that every request carries. It is read anew each time: another window may have signed in since. */
export function secretHeader(): Record<string, string> {
  const secret = current();
  return secret === '' ? {} : { 'X-Mucat': secret };
}

export function socketProtocols(): string[] {
  const secret = current();
  return secret === '' ? [] : [PROTOCOL, secret];
}

function current(): string {
  return readStored(KEY) ?? unstored;
}
