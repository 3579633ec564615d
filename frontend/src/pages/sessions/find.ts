/** Tags as they are typed. */

/** The tags with a new one; what is empty or there already adds nothing. A comma separates several. */
export function withTags(tags: readonly string[], text: string): string[] {
  const known = new Set(tags.map((tag) => tag.toLocaleLowerCase()));
  const added = text
    .split(',')
    .map((tag) => tag.trim())
    .filter((tag) => tag !== '' && !known.has(tag.toLocaleLowerCase()));
  return [...tags, ...new Set(added)];
}
