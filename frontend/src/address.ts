/** What is seen of a page, by name, as the address says it after its question mark: `at`, `from`, `signals`. */
export type Seen = ReadonlyMap<string, string>;

export const readSeen = (text: string): Seen => new Map(new URLSearchParams(text));

export const writeSeen = (seen: Seen): string => new URLSearchParams([...seen]).toString().replaceAll('%2C', ',').replaceAll('%2F', '/');

/** The same with these; null takes a name out. */
export function changedSeen(seen: Seen, changes: Readonly<Record<string, string | number | null>>): Seen {
  const changed = new Map(seen);
  for (const [name, value] of Object.entries(changes)) {
    if (value === null) changed.delete(name);
    else changed.set(name, String(value));
  }
  return changed;
}
