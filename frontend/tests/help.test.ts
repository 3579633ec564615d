import { expect, test } from 'vitest';
import { helpAddress } from '../src/shell/help';

test('a view within a page has a chapter of its own, or that of its page', () => {
  expect(helpAddress('tune', [])).toBe('/help/use/tune/');
  expect(helpAddress('tune', ['relay'])).toBe('/help/use/tune/');
  expect(helpAddress('tune', ['vision'])).toBe('/help/use/vision/');
  expect(helpAddress('sessions', ['compare', '7,9'])).toBe('/help/use/compare/');
  expect(helpAddress('sessions', ['7'])).toBe('/help/use/sessions/');
  expect(helpAddress('unknown', ['constructor'])).toBe('/help/');
});
