import { describe, expect, it } from 'vitest';
import { NOTE_MAX, noteProblem } from '../src/parts/notes/length';
import { renderMarkdown } from '../src/parts/notes/markdown';

describe('the Markdown of a note', () => {
  it('becomes HTML with its headings below those of the page', () => {
    expect(renderMarkdown('# Dive\n\n- **deep**\n- *cold*')).toBe(
      '<h4>Dive</h4>\n<ul>\n<li><strong>deep</strong></li>\n<li><em>cold</em></li>\n</ul>\n',
    );
    expect(renderMarkdown('###### small')).toBe('<h6>small</h6>\n');
  });

  it('shows HTML as text', () => {
    for (const html of ['<script>alert(1)</script>', '<img src=x onerror=alert(1)>', 'a <b onclick="alert(1)">b</b>', '<iframe src="//x"></iframe>', '<!-- x -->']) {
      expect(renderMarkdown(html)).not.toMatch(/<(?!\/?p>)/);
    }
  });

  it('has no link that does anything but lead somewhere', () => {
    for (const address of ['javascript:alert(1)', 'JaVaScRiPt:alert(1)', 'java&#115;cript:alert(1)', 'vbscript:x', 'data:text/html,x', 'file:///etc/passwd']) {
      expect(renderMarkdown(`[press](${address})`)).not.toContain('<a');
      expect(renderMarkdown(`<${address}>`)).not.toContain('<a');
      expect(renderMarkdown(`[press]\n\n[press]: ${address}`)).not.toContain('<a');
    }
    expect(renderMarkdown('[a" onclick="alert(1)](https://x.example/"onclick="alert(1))')).not.toMatch(/<a[^>]* onclick/);
  });

  it('opens other computers apart, and moments of sessions here', () => {
    expect(renderMarkdown('https://example.org')).toContain('target="_blank" rel="noreferrer"');
    expect(renderMarkdown('[then](#/replay/3?at=5)')).toBe('<p><a href="#/replay/3?at=5">then</a></p>\n');
  });

  it('fetches no picture, and has no style that the page’s policy forbids', () => {
    expect(renderMarkdown('![](https://x.example/who.png)')).not.toContain('<img');
    expect(renderMarkdown('| a |\n|--:|\n| 1 |')).toContain('<td align="right">1</td>');
    expect(renderMarkdown('| a |\n|--:|\n| 1 |')).not.toContain('style');
  });
});

describe('the length of a note', () => {
  it('is counted in characters, without what surrounds it', () => {
    expect(noteProblem('🐢'.repeat(NOTE_MAX))).toBe('');
    expect(noteProblem(` ${'a'.repeat(NOTE_MAX)}\n`)).toBe('');
    expect(noteProblem('a'.repeat(NOTE_MAX + 1))).toBe('This note has 10\u202f001 characters, and may have 10\u202f000. Shorten it.');
  });
});
