import { readStored, writeStored } from '../storage';

/** A text that somebody is writing: kept under `key` while another page is looked at, and over a reload. */
export class Draft {
  constructor(private readonly key: string) {}

  read(): string {
    return readStored(this.key, 'sessionStorage') ?? '';
  }

  write(text: string): void {
    writeStored(this.key, text, 'sessionStorage');
  }
}
