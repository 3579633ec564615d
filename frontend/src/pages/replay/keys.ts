/** s that the arrow keys seek by, without and with shift */
export const STEP = 5;
export const STEP_FAR = 30;

/** What a key does in a replay: play or pause, or s to seek by; null where it is not for the replay. */
export function keyAction(event: KeyboardEvent): 'toggle' | number | null {
  if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return null;
  const place = event.target instanceof Element ? event.target : null;
  if (place?.closest('input:not([type="range"]), textarea, select, [role="tablist"]')) return null;
  if (event.key === ' ') {
    // Who has come to a button by the keyboard presses it by the same key.
    return event.repeat || place?.matches('button:focus-visible, a:focus-visible') ? null : 'toggle';
  }
  const direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  return direction === undefined ? null : direction * (event.shiftKey ? STEP_FAR : STEP);
}
