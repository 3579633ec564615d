import { expect, test } from 'vitest';
import type { PageName } from '../src/router.svelte';
import { helpAddress } from '../src/shell/help';
import { HelpDrawer } from '../src/shell/help.svelte';
import { pages } from '../src/texts/pages';

test('a view within a page has a chapter of its own, or that of its page', () => {
  expect(helpAddress('tune', [])).toBe('/help/use/tune/');
  expect(helpAddress('tune', ['relay'])).toBe('/help/use/tune/');
  expect(helpAddress('tune', ['vision'])).toBe('/help/use/vision/');
  expect(helpAddress('sessions', ['compare', '7,9'])).toBe('/help/use/compare/');
  expect(helpAddress('sessions', ['7'])).toBe('/help/use/sessions/');
  expect(helpAddress('unknown', ['constructor'])).toBe('/help/');
});

const opener = { focus: () => undefined };

test('a press before the drawer is fetched opens it when it comes; a tab is for a drawer that cannot be fetched', async () => {
  const coming = new HelpDrawer(new Promise(() => undefined));
  expect(coming.toggle('/help/use/tune/', opener)).toBe(true);
  expect(coming.address).toBe('/help/use/tune/');

  const gone = Promise.resolve(null);
  const missing = new HelpDrawer(gone);
  await gone;
  expect(missing.toggle('/help/use/tune/', opener)).toBe(false);
  expect(missing.address).toBeNull();
});

test('each page has a chapter of its own', () => {
  const names = Object.keys(pages) as PageName[];
  const chapters = names.filter((name) => name !== 'unknown').map((name) => helpAddress(name, []));
  expect(new Set(chapters).size).toBe(names.length - 1);
  expect(chapters).not.toContain(helpAddress('unknown', []));
});
