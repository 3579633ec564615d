import type { LinkFrame } from '../../api';
import { fixed } from '../../format';
import { system } from '../../texts/system';

const texts = system.frames;

export type Way = 'both' | 'sent' | 'received';

/** What may be chosen beside the kinds of message. */
export const ANY = '';
export const INVALID = 'invalid';

/** Names of the packets by their content. */
const WORDS: Readonly<Record<string, string>> = texts.kinds;

export const kindWord = (kind: string): string => WORDS[kind] ?? kind;

/** The messages of a frame in words; of several of a kind, how many. */
export function messageWords(frame: LinkFrame): string {
  const counts = new Map<string, number>();
  for (const kind of frame.kinds) counts.set(kind, (counts.get(kind) ?? 0) + 1);
  const words = [...counts].map(([kind, count]) => (count === 1 ? kindWord(kind) : texts.several(count, kindWord(kind))));
  return words.length > 0 ? words.join(', ') : texts.unreadable;
}

/** Bytes on the line, with the closing zero. */
export const sizeOf = (frame: LinkFrame): number => frame.bytes.length / 2;

/** Bytes in hexadecimal, two digits each. */
export const spacedBytes = (frame: LinkFrame): string => frame.bytes.replace(/..(?=.)/g, '$& ');

/** The number that a frame bears: of a reliable one it is marked, since those count by themselves. */
export function numberWords(frame: LinkFrame): string {
  if (frame.number === null) return '';
  if (frame.open) return texts.open;
  return frame.reliable ? `R ${frame.number}` : String(frame.number);
}

/** Every kind of message that occurs, in the order of the words. */
export function kindsIn(frames: readonly LinkFrame[]): string[] {
  return [...new Set(frames.flatMap((frame) => frame.kinds))].sort((a, b) => kindWord(a).localeCompare(kindWord(b)));
}

/** The frames of this direction that hold this kind of message, or were thrown away. */
export function matching(frames: readonly LinkFrame[], way: Way, kind: string): readonly LinkFrame[] {
  return frames.filter(
    (frame) =>
      (way === 'both' || frame.sent === (way === 'sent')) &&
      (kind === ANY || (kind === INVALID ? frame.problem !== '' : frame.kinds.includes(kind))),
  );
}

/** Whole ms of a frame, counted back from the newest one, in s. */
export const since = (time: number, newest: number): string => fixed(Math.round((time - newest) * 1000) / 1000, 3, 'space');

/** The frames as a person would keep them: what they are of, then a line each. */
export function asText(title: string, frames: readonly LinkFrame[], newest: number): string {
  const lines = frames.map((frame) =>
    [
      `${(frame.time - newest).toFixed(3)} s`,
      frame.sent ? texts.file.toBoard : texts.file.fromBoard,
      messageWords(frame),
      numberWords(frame) === '' ? '-' : texts.file.number(numberWords(frame)),
      frame.acknowledged === null ? '-' : texts.file.awaits(frame.acknowledged),
      `${sizeOf(frame)} B`,
      frame.problem === '' ? texts.file.valid : texts.file.invalid(frame.problem),
      frame.bytes,
    ].join('\t'),
  );
  return `${[title, ...lines].join('\n')}\n`;
}
