import { PITCH, ROLL, X, Y, YAW, Z, type Push } from './axes';

/** By where a key lies, as on a US keyboard, so that hands find it on others too. */
export const KEYS: Readonly<Record<string, Push>> = {
  KeyW: { axis: X, amount: 1 },
  KeyS: { axis: X, amount: -1 },
  KeyA: { axis: YAW, amount: -1 },
  KeyD: { axis: YAW, amount: 1 },
  KeyQ: { axis: Y, amount: -1 },
  KeyE: { axis: Y, amount: 1 },
  KeyR: { axis: Z, amount: -1 },
  KeyF: { axis: Z, amount: 1 },
  ArrowUp: { axis: PITCH, amount: 1 },
  ArrowDown: { axis: PITCH, amount: -1 },
  ArrowLeft: { axis: ROLL, amount: -1 },
  ArrowRight: { axis: ROLL, amount: 1 },
};

export const LEGEND = [
  { keys: 'W S', what: 'ahead, back' },
  { keys: 'A D', what: 'turn left, right' },
  { keys: 'R F', what: 'up, down' },
  { keys: 'Q E', what: 'left, right' },
  { keys: '↑ ↓', what: 'nose up, down' },
  { keys: '← →', what: 'roll left, right' },
] as const;

/** What a key that goes down asks for; null where it is meant for something else, a field to type in above all. */
export function pushOf(event: KeyboardEvent): Push | null {
  if (event.ctrlKey || event.metaKey || event.altKey) return null;
  const place = event.target instanceof Element ? event.target : null;
  if (place?.closest('input, textarea, select, [contenteditable], [role="tablist"], [role="slider"]')) return null;
  return KEYS[event.code] ?? null;
}
