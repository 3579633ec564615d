const KEY = 'mucat-scenario';

/** The text of the scenario that somebody is writing: kept while another page is looked at, and over a reload. */
export function readDraft(): string {
  try {
    return sessionStorage.getItem(KEY) ?? '';
  } catch {
    // Storage may be forbidden; then the draft lasts as long as the page is looked at.
    return '';
  }
}

export function writeDraft(text: string): void {
  try {
    sessionStorage.setItem(KEY, text);
  } catch {
    // As above.
  }
}
