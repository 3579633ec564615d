import { describe, expect, it } from 'vitest';
import { Draft } from '../src/parts/draft';
import { OwnText } from '../src/parts/ownText.svelte';

/** A draft that no browser stores. */
class MemoryDraft extends Draft {
  #text = '';

  override read(): string {
    return this.#text;
  }

  override write(text: string): void {
    this.#text = text;
  }
}

describe('a text chosen from a list or written', () => {
  const HOVER = { name: 'hover', text: 'hover 1', mark: 'h1' };
  const DIVE = { name: 'dive', text: 'dive 1', mark: 'd1' };
  const LIST = [HOVER, DIVE];
  const LATER = [HOVER, { name: 'dive', text: 'dive 2', mark: 'd2' }];
  const begin = () => {
    const draft = new MemoryDraft('test');
    return { own: new OwnText(draft), again: () => new OwnText(draft) };
  };

  it('is the first of the list at first', () => {
    expect(begin().own.follow('', LIST)).toBe('hover 1');
  });

  it('that nobody has changed is as the list has it later', () => {
    const { own, again } = begin();
    own.choose(DIVE);
    const later = again();
    expect(later.follow('dive 1', LATER)).toBe('dive 2');
    expect([later.text, later.origin]).toEqual(['', { name: 'dive', mark: 'd2' }]);
    expect(again().follow('dive 2', [HOVER])).toBe('hover 1');
  });

  it('that somebody has changed stays, and so does what it began as', () => {
    const { own, again } = begin();
    own.choose(DIVE);
    own.write('dive mine', LIST);
    own.choose(HOVER);
    const later = again();
    expect([later.follow('hover 1', LATER), later.text]).toEqual(['hover 1', 'dive mine']);
    expect([later.choose(), later.origin]).toEqual(['dive mine', { name: 'dive', mark: 'd1' }]);
    expect(later.follow('dive mine', LATER)).toBe('dive mine');
  });

  it('is nobody’s own once it is as the list has it', () => {
    const { own } = begin();
    own.choose(DIVE);
    own.write('dive 1x', LIST);
    own.write('dive 1', LIST);
    expect(own.text).toBe('');
    own.write('hover 1', LIST);
    expect(own.origin).toEqual({ name: 'hover', mark: 'h1' });
  });
});
