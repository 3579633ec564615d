import type { DebugLine } from '../../generated/topics';
import { fold } from '../../searching';
import { panels as texts } from '../../texts/panels';

/** Words of DebugLevel, in its order. */
export const LEVELS = ['debug', 'info', 'warning', 'error'] as const;

export function levelWord(level: number): string {
  return LEVELS[level] ?? texts.console.unknownLevel(level);
}

/** The lines of at least this level that hold this text, whatever its case and accents. */
export function matching(lines: readonly DebugLine[], level: number, text: string): readonly DebugLine[] {
  const wanted = fold(text.trim());
  if (level === 0 && wanted === '') return lines;
  return lines.filter((line) => line.level >= level && fold(line.text).includes(wanted));
}

/** Lines lost since the board had counted `before`; a board that was reset counts anew. */
export function lostSince(before: number, count: number): number {
  return count < before ? count : count - before;
}

/** The lines as a person would paste them: time, level and text. */
export function asText(lines: readonly DebugLine[], date: (time: number) => Date): string {
  return lines.map((line) => `${date(line.time).toISOString()} ${levelWord(line.level)} ${line.text}`).join('\n');
}
