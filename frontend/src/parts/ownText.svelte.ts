import type { Draft } from './draft';

/** The text of one's own in a list: the last chosen one that is none of the list's. To be made while a component begins. */
export class OwnText {
  text = $state('');

  constructor(draft: Draft, chosen: () => string, listed: (text: string) => boolean) {
    this.text = draft.read();
    $effect(() => {
      const text = chosen();
      if (text === '' || listed(text)) return;
      this.text = text;
      draft.write(text);
    });
  }
}
