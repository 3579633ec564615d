/** Which sessions are shown: found by words, by tags. */
import type { Session } from '../../api';

/** Every tag that is in use, in alphabetical order. */
export function tagsOf(sessions: readonly Session[]): string[] {
  return [...new Set(sessions.flatMap(({ tags }) => tags))].sort((a, b) => a.localeCompare(b));
}

/** Those with each word somewhere in name, note, tags or scenario, and with each tag. */
export function find(sessions: readonly Session[], words: string, tags: readonly string[]): Session[] {
  const wanted = words.toLocaleLowerCase().split(/\s+/).filter(Boolean);
  return sessions.filter((session) => {
    if (!tags.every((tag) => session.tags.includes(tag))) return false;
    const text = [session.name, session.note, session.scenario_name, ...session.tags].join('\n').toLocaleLowerCase();
    return wanted.every((word) => text.includes(word));
  });
}

/** The list with `one` added, or taken out where it was in it. */
export function toggle<T>(list: readonly T[], one: T): T[] {
  return list.includes(one) ? list.filter((other) => other !== one) : [...list, one];
}

/** The tags with a new one; what is empty or there already adds nothing. A comma separates several. */
export function withTags(tags: readonly string[], text: string): string[] {
  const known = new Set(tags.map((tag) => tag.toLocaleLowerCase()));
  const added = text
    .split(',')
    .map((tag) => tag.trim())
    .filter((tag) => tag !== '' && !known.has(tag.toLocaleLowerCase()));
  return [...tags, ...new Set(added)];
}
