import { afterEach, describe, expect, it, vi } from 'vitest';
import { FinderState } from '../src/finder.svelte';
import { LEFT_HAND, RIGHT_HAND } from '../src/drive/keys';
import { readChapters } from '../src/finder/chapters';
import { keyGroups } from '../src/finder/keys';
import { matching, type Finding } from '../src/finder/search';

const finding = (name: string): Finding => ({ kind: 'page', name, go: () => undefined });
const names = (typed: string, ...all: string[]) => matching(all.map(finding), typed).map(({ name }) => name);

describe('finding', () => {
  it('takes names with all words, those first that begin with them', () => {
    expect(names('se', 'Missions', 'Use', 'Sessions')).toEqual(['Sessions', 'Use']);
    expect(names('view flight', 'Flight view', 'View')).toEqual(['Flight view']);
    expect(names('(.*', 'Flight view')).toEqual([]);
    expect(names('  ', 'a', 'b')).toEqual(['a', 'b']);
  });

  it('shows a few of many', () => {
    expect(names('x', ...Array.from({ length: 10_000 }, (_, place) => `x${place}`))).toHaveLength(8);
  });
});

describe('the list of keys', () => {
  it('has every key that drives', () => {
    const caps = keyGroups().flatMap(({ keys }) => keys.map((key) => key.caps));
    for (const { cap } of [...LEFT_HAND, ...RIGHT_HAND].flat()) expect(caps).toContain(cap);
  });
});

describe('FinderState', () => {
  const key = (name: string, more: object = {}) => ({ key: name, ctrlKey: false, metaKey: false, altKey: false, ...more }) as KeyboardEvent;

  it('takes what is typed before the search is there, and leaves Esc and everything else to the page', () => {
    const finder = new FinderState();
    expect(finder.takes(key('f'))).toBe(false);
    finder.shown = 'find';
    for (const one of ['f', 'i', ' ', 'Enter']) expect(finder.takes(key(one))).toBe(true);
    for (const other of [key('Escape'), key('Tab'), key('k', { ctrlKey: true })]) expect(finder.takes(other)).toBe(false);
    expect(finder.typed).toBe('fi ');
    finder.ready = true;
    expect(finder.takes(key('n'))).toBe(false);
  });
});

describe('a chapter of the help', () => {
  afterEach(() => void vi.unstubAllGlobals());

  it('is named with its page, unless it is the page itself', async () => {
    const docs = [
      { location: 'glossary/', title: 'Glossary' },
      { location: 'glossary/#depth', title: 'Depth' },
      { location: 'use/panels/', title: 'Panels' },
      { location: 'use/panels/#depth', title: 'Depth' },
    ];
    vi.stubGlobal('fetch', () => Promise.resolve(Response.json({ docs })));
    expect((await readChapters()).map(({ title }) => title)).toEqual(['Glossary', 'Depth · Glossary', 'Panels', 'Depth · Panels']);
  });

  it('is none where there is no help', async () => {
    vi.stubGlobal('fetch', () => Promise.reject(new TypeError('gone')));
    expect(await readChapters()).toEqual([]);
  });
});
