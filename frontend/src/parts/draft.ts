/** A text that somebody is writing: kept under `key` while another page is looked at, and over a reload. */
export class Draft {
  constructor(private readonly key: string) {}

  read(): string {
    try {
      return sessionStorage.getItem(this.key) ?? '';
    } catch {
      // Storage may be forbidden; then the draft lasts as long as the page is looked at.
      return '';
    }
  }

  write(text: string): void {
    try {
      sessionStorage.setItem(this.key, text);
    } catch {
      // As above.
    }
  }
}
