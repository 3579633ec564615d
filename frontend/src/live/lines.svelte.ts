/** The newest entries of a list that only grows, and the count of those that it has discarded. */
export class Lines<T> {
  entries = $state.raw<readonly T[]>([]);
  /** how many entries made room for newer ones */
  discarded = $state(0);
  /** how many entries ever came; grows with every one */
  added = $state(0);

  /** @param order of the entries, the oldest first; without it they stand as they come */
  constructor(
    readonly capacity: number,
    private readonly order: ((one: T, other: T) => number) | null = null,
  ) {}

  append(entries: readonly T[]): void {
    this.added += entries.length;
    const all = this.entries.concat(entries);
    if (this.order !== null) all.sort(this.order);
    const surplus = Math.max(0, all.length - this.capacity);
    this.discarded += surplus;
    this.entries = surplus > 0 ? all.slice(surplus) : all;
  }

  clear(): void {
    this.entries = [];
    this.discarded = 0;
  }
}
