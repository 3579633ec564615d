/** Comparison of texts in a search; the server does the same in platform/searching.py. */

/** The text without case, accents and other forms of the same letters: "Öö ﬁ ß" is "oo fi ss". */
export function fold(text: string): string {
  // Upper case first: it makes SS of ß.
  return text.normalize('NFKD').toUpperCase().toLowerCase().normalize('NFKD').replace(/[\u0300-\u036f]/g, '');
}

/** True where every word of the search occurs in the text. */
export function hasWords(text: string, search: string): boolean {
  const folded = fold(text);
  return fold(search)
    .split(/\s+/)
    .every((word) => folded.includes(word));
}
