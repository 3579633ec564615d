import { count } from '../../format';
import { notes as texts } from '../../texts/notes';

/** characters of a note; server/library/schemas.py has the same */
export const NOTE_MAX = 10_000;

/** Why a note cannot be saved; '' where it can. Characters are counted as the server does: an emoji is one. */
export function noteProblem(text: string): string {
  const length = Array.from(text.trim()).length;
  return length > NOTE_MAX ? texts.tooLong(count(length), count(NOTE_MAX)) : '';
}
