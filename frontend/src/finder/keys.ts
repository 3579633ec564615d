/** All keys of the page by where they work, read from where they are declared. */
import { capOf } from '../drive/keyCaps';
import { LEFT_HAND, RIGHT_HAND } from '../drive/keys';
import { SPEEDS } from '../drive/handling.svelte';
import { STEP, STEP_FAR } from '../pages/replay/keys';
import { LETTERS } from '../shortcuts.svelte';
import { finder } from '../texts/finder';

export interface KeyGroup {
  readonly title: string;
  readonly keys: readonly { readonly caps: string; readonly what: string }[];
}

const texts = finder.keys;

/** @param letters what stands on the keys of this keyboard, by their codes */
export function keyGroups(letters: ReadonlyMap<string, string> = new Map()): KeyGroup[] {
  const names = Object.keys(LETTERS) as (keyof typeof LETTERS)[];
  return [
    {
      title: texts.everywhere,
      keys: [
        { caps: 'Esc', what: texts.stop },
        { caps: 'Ctrl+K', what: texts.find },
        ...names.map((name) => ({ caps: LETTERS[name].map((letter) => letter.toUpperCase()).join(', '), what: texts.letters[name] })),
      ],
    },
    {
      title: texts.driving,
      keys: [
        ...[...LEFT_HAND, ...RIGHT_HAND].flat().map(({ code, cap, what }) => ({ caps: capOf(letters, code, cap), what })),
        { caps: 'Shift + ↑ ↓ ← →', what: texts.shifted },
        { caps: `1 – ${SPEEDS}`, what: texts.speed },
        { caps: capOf(letters, 'KeyG', 'G'), what: texts.holdDepth },
        { caps: capOf(letters, 'KeyH', 'H'), what: texts.holdHeading },
      ],
    },
    {
      title: texts.replay,
      keys: [
        { caps: texts.space, what: texts.toggle },
        { caps: '← →', what: texts.seek(STEP) },
        { caps: 'Shift + ← →', what: texts.seek(STEP_FAR) },
      ],
    },
  ];
}
