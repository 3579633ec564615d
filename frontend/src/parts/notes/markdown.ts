/** Markdown of notes, as HTML in which nothing acts: HTML in a note is shown as text, and a link that runs a script is none. */
import markdownIt, { type Token } from 'markdown-it';

/** The page's own headings come first. */
const HEADING_FIRST = 4;
const HEADING_LAST = 6;

const notes = markdownIt('default', { html: false, breaks: true, linkify: true });
// A picture of another computer would tell it who reads, and the page's policy shows none.
notes.disable('image');
notes.core.ruler.push('page', ({ tokens }) => {
  for (const token of tokens.flatMap((one) => [one, ...(one.children ?? [])])) adapt(token);
});

/** The HTML of a note. */
export function renderMarkdown(text: string): string {
  return notes.render(text);
}

function adapt(token: Token): void {
  if (token.tag.startsWith('h') && token.type.startsWith('heading')) {
    token.tag = `h${Math.min(HEADING_LAST, Number(token.tag.slice(1)) + HEADING_FIRST - 1)}`;
  }
  // The page's policy forbids styles in attributes.
  const [, align] = /^text-align:(\w+)$/.exec(String(token.attrGet('style'))) ?? [];
  token.attrs = token.attrs?.filter(([name]) => name !== 'style') ?? null;
  if (align !== undefined) token.attrSet('align', align);
  if (token.type === 'link_open' && !String(token.attrGet('href')).startsWith('#')) {
    token.attrSet('target', '_blank');
    token.attrSet('rel', 'noreferrer');
  }
}
