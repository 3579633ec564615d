import type { Draft } from './draft';

/** An entry of a list of texts; `mark` tells its text from a later one. */
interface Listed {
  readonly name: string;
  readonly text: string;
  readonly mark?: string;
}

interface Origin {
  readonly name: string;
  /** null where it is not known */
  readonly mark: string | null;
}

interface Stored {
  readonly text: string;
  readonly own: Origin;
  readonly origin: Origin;
}

const NOWHERE: Origin = { name: '', mark: null };

/**
 * A text that is chosen from a list or written over one of it. One's own is what was written and is none of the list's;
 * what nobody has changed follows the list. To be made while a component begins.
 */
export class OwnText {
  /** one's own; '' without */
  text = $state('');
  /** the entry that the present text began as */
  origin = $state.raw(NOWHERE);
  /** the entry that one's own began as */
  #own = NOWHERE;
  readonly #draft: Draft;

  constructor(draft: Draft) {
    this.#draft = draft;
    try {
      const { text, own, origin } = JSON.parse(draft.read()) as Stored;
      [this.text, this.#own, this.origin] = [text, own, origin];
    } catch {
      // Nothing was chosen yet.
    }
  }

  /** Return the text of this entry; without one one's own. */
  choose(entry?: Listed): string {
    this.origin = entry ? originOf(entry) : this.#own;
    this.#remember();
    return entry?.text ?? this.text;
  }

  /** Somebody writes this text: it is one's own, unless the list has it so. */
  write(text: string, list: readonly Listed[]): void {
    const entry = list.find((one) => one.text === text);
    if (entry) this.origin = originOf(entry);
    this.text = entry ? '' : text;
    this.#own = this.origin;
    this.#remember();
  }

  /** Return what is to be shown where `text` was, of an earlier list: one's own stays, and what is untouched is as the list has it now. */
  follow(text: string, list: readonly Listed[]): string {
    if (text !== '' && (text === this.text || list.some((one) => one.text === text))) return text;
    return this.choose(list.find(({ name }) => name === this.origin.name) ?? list[0]);
  }

  #remember(): void {
    const stored: Stored = { text: this.text, own: this.#own, origin: this.origin };
    this.#draft.write(JSON.stringify(stored));
  }
}

const originOf = ({ name, mark }: Listed): Origin => ({ name, mark: mark ?? null });
