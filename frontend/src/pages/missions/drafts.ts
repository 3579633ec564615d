import { Draft } from '../../parts/draft';
import { isTable } from './cards';

/** the text that is being written */
export const textDraft = new Draft('mucat-mission');
const sourceDraft = new Draft('mucat-mission-source');

/** What a text that is being written was opened as. `name` is of the library; empty where it is not from there. */
export interface Source {
  readonly name: string;
  readonly text: string;
  /** of the text in the library; null where it is not known */
  readonly mark: string | null;
}

/** of what is not from the library */
export const NOTHING: Source = { name: '', text: '', mark: '' };

export function readSource(): Source {
  try {
    const read: unknown = JSON.parse(sourceDraft.read());
    if (isTable(read) && typeof read.name === 'string' && typeof read.text === 'string') return { name: read.name, text: read.text, mark: typeof read.mark === 'string' ? read.mark : null };
  } catch {
    // Nothing was opened.
  }
  return { name: '', text: '', mark: null };
}

export const writeSource = (source: Source): void => sourceDraft.write(JSON.stringify(source));
