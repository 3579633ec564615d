/** The newest entries of a list that only grows, and the count of those it had to let go. */
export class Lines<T> {
  entries = $state.raw<readonly T[]>([]);
  /** how many entries made room for newer ones */
  letGo = $state(0);
  /** how many entries ever came; grows with every one */
  added = $state(0);

  constructor(readonly capacity: number) {}

  append(entries: readonly T[]): void {
    this.added += entries.length;
    const all = this.entries.concat(entries);
    const surplus = Math.max(0, all.length - this.capacity);
    this.letGo += surplus;
    this.entries = surplus > 0 ? all.slice(surplus) : all;
  }

  clear(): void {
    this.entries = [];
    this.letGo = 0;
  }
}
