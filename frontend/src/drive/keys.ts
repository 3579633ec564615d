import { PITCH, ROLL, X, Y, YAW, Z, type Push } from './axes';
import { SPEEDS } from './handling.svelte';
import type { Holdable } from './holds';
import { isTyping } from '../shortcuts.svelte';
import { drive as texts } from '../texts/drive';

/** A key of the map: where it lies (as on a US keyboard, so that hands find it on others too), and what it does. */
export interface Key {
  readonly code: string;
  readonly cap: string;
  readonly what: string;
  readonly push: Push;
}

const key = (code: string, cap: string, what: string, axis: Push['axis'], amount: number): Key => ({
  code,
  cap,
  what,
  push: { axis, amount },
});

/** In rows, as they lie. */
export const LEFT_HAND: readonly (readonly Key[])[] = [
  [
    key('KeyQ', 'Q', texts.keys.left, Y, -1),
    key('KeyW', 'W', texts.keys.forwards, X, 1),
    key('KeyE', 'E', texts.keys.right, Y, 1),
    key('KeyR', 'R', texts.keys.up, Z, -1),
  ],
  [
    key('KeyA', 'A', texts.keys.turnLeft, YAW, -1),
    key('KeyS', 'S', texts.keys.back, X, -1),
    key('KeyD', 'D', texts.keys.turnRight, YAW, 1),
    key('KeyF', 'F', texts.keys.down, Z, 1),
  ],
];
export const RIGHT_HAND: readonly (readonly Key[])[] = [
  [key('ArrowUp', '↑', texts.keys.noseUp, PITCH, 1)],
  [
    key('ArrowLeft', '←', texts.keys.rollLeft, ROLL, -1),
    key('ArrowDown', '↓', texts.keys.noseDown, PITCH, -1),
    key('ArrowRight', '→', texts.keys.rollRight, ROLL, 1),
  ],
];
const PUSHES = new Map([...LEFT_HAND, ...RIGHT_HAND].flat().map(({ code, push }) => [code, push]));
/** With shift the arrows alone will do: forwards, back and turning. */
const SHIFTED = new Map<string, Push>([
  ['ArrowUp', { axis: X, amount: 1 }],
  ['ArrowDown', { axis: X, amount: -1 }],
  ['ArrowLeft', { axis: YAW, amount: -1 }],
  ['ArrowRight', { axis: YAW, amount: 1 }],
]);
const HOLDS: Readonly<Record<string, Holdable>> = { KeyG: 'depth', KeyH: 'heading' };
/** Where arrow keys choose or move something themselves. */
const TURNED = 'input, [role="tablist"], [role="slider"], [role="radiogroup"]';

type Action =
  | { readonly do: 'push'; readonly push: Push }
  | { readonly do: 'speed'; readonly speed: number }
  | { readonly do: 'hold'; readonly loop: Holdable };

/** Action of a key that goes down; null where it is meant for something else, a field to type in above all. */
export function actionOf(event: KeyboardEvent): Action | null {
  if (event.ctrlKey || event.metaKey || event.altKey) return null;
  if (isTyping(event.target)) return null;
  if (event.code.startsWith('Arrow') && event.target instanceof Element && event.target.closest(TURNED)) return null;
  const push = (event.shiftKey ? SHIFTED.get(event.code) : undefined) ?? PUSHES.get(event.code);
  if (push !== undefined) return { do: 'push', push };
  const [, digit] = /^(?:Digit|Numpad)([1-9])$/.exec(event.code) ?? [];
  if (digit !== undefined && Number(digit) <= SPEEDS) return { do: 'speed', speed: Number(digit) };
  const loop = HOLDS[event.code];
  return loop === undefined ? null : { do: 'hold', loop };
}
