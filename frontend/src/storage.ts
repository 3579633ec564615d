/** Values that this browser remembers for the page. Storage may be forbidden; then a choice lasts as long as the page. */

/** `sessionStorage` lasts as long as the tab. */
type Place = 'localStorage' | 'sessionStorage';

export function readStored(key: string, place: Place = 'localStorage'): string | null {
  try {
    return globalThis[place].getItem(key);
  } catch {
    return null;
  }
}

export function writeStored(key: string, value: string, place: Place = 'localStorage'): void {
  try {
    globalThis[place].setItem(key, value);
  } catch {
    // As above.
  }
}

/** The JSON value that is stored; null where there is none, or one that cannot be read. */
export function readStoredJson(key: string, place: Place = 'localStorage'): unknown {
  try {
    return JSON.parse(readStored(key, place) ?? 'null');
  } catch {
    return null;
  }
}
