/** What was written before and after, to go back to and forth. */

const ENTRIES_MOST = 200;

export interface History<Entry> {
  readonly entries: readonly Entry[];
  /** of the one that is shown */
  readonly at: number;
  /** what the last change was of; one more of the same does not count as another */
  readonly key: string;
}

export const begin = <Entry>(entry: Entry): History<Entry> => ({ entries: [entry], at: 0, key: '' });

/** Changes in a row with the same `key`, as of letters of one field, are undone together; '' is never the same. */
export function record<Entry>(history: History<Entry>, entry: Entry, key: string): History<Entry> {
  const together = key !== '' && key === history.key;
  const before = history.entries.slice(0, history.at + (together ? 0 : 1));
  const entries = [...before, entry].slice(-ENTRIES_MOST);
  return { entries, at: entries.length - 1, key };
}

/** Go back by -1 or forth by 1; the same history where there is nothing. */
export function go<Entry>(history: History<Entry>, by: -1 | 1): History<Entry> {
  const at = history.at + by;
  return history.entries[at] === undefined ? history : { ...history, at, key: '' };
}

/** The shown entry as it is known by now. */
export function amend<Entry>(history: History<Entry>, entry: Entry): History<Entry> {
  return { ...history, entries: history.entries.map((one, at) => (at === history.at ? entry : one)) };
}
