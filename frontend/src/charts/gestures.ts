import type { ChartTime } from './time.svelte';
import { viewUntil, type View } from './view';

/** What pointers, wheel and keys need of the chart over which they are. */
export interface Under {
  readonly time: ChartTime;
  view(): View;
  now(): number;
  /** shows what is being chosen, as shares of the width; null where nothing is */
  select(range: readonly [number, number] | null): void;
}

const WHEEL = 0.0015;
const KEY_ZOOM = 0.7;
/** share of the view by which a key moves the cursor, and the view */
const KEY_STEP = 1 / 200;
const KEY_MOVE = 0.5;
/** px that a pointer must move for a press to be a drag */
const DRAG = 5;

/** Drag or wheel or pinch to zoom, with Shift to move, hover or touch or arrows for the cursor. Returns what ends it. */
export function listen(node: HTMLElement, under: Under): () => void {
  const { time } = under;
  const pointers = new Map<number, number>();
  let pressed: { at: number; view: View; moves: boolean } | null = null;
  let dragged = false;

  const share = (x: number) => {
    const { left, width } = node.getBoundingClientRect();
    return Math.min(Math.max((x - left) / Math.max(width, 1), 0), 1);
  };
  const timeAt = (x: number, view = under.view()) => view.start + share(x) * view.seconds;
  const point = (x: number) => {
    time.ago = (1 - share(x)) * under.view().seconds;
  };

  function down(event: PointerEvent) {
    if (event.pointerType === 'mouse' && event.button !== 0) return;
    pointers.set(event.pointerId, event.clientX);
    node.setPointerCapture(event.pointerId);
    dragged = false;
    if (event.pointerType === 'mouse') pressed = { at: event.clientX, view: under.view(), moves: event.shiftKey };
    else point(event.clientX);
  }

  function move(event: PointerEvent) {
    const before = pointers.get(event.pointerId);
    if (pointers.size === 2 && before !== undefined) pinch(event.pointerId, before, event.clientX);
    else point(event.clientX);
    if (before !== undefined) pointers.set(event.pointerId, event.clientX);
    if (pressed === null) return;
    dragged ||= Math.abs(event.clientX - pressed.at) >= DRAG;
    if (!dragged) return;
    if (pressed.moves) {
      time.move(pressed.view, timeAt(pressed.at, pressed.view) - timeAt(event.clientX, pressed.view), under.now());
    } else {
      under.select([share(pressed.at), share(event.clientX)].sort((one, other) => one - other) as [number, number]);
    }
  }

  function up(event: PointerEvent) {
    pointers.delete(event.pointerId);
    if (pressed !== null && dragged && !pressed.moves && event.type === 'pointerup') {
      const view = under.view();
      const [start = 0, end = 0] = [timeAt(pressed.at, view), timeAt(event.clientX, view)].sort((one, other) => one - other);
      time.show(viewUntil(end, end - start), under.now());
    }
    pressed = null;
    under.select(null);
  }

  /** Both fingers stay over the moments that they touched. */
  function pinch(moving: number, from: number, to: number) {
    const still = [...pointers].find(([pointer]) => pointer !== moving)?.[1];
    if (still === undefined || Math.abs(to - still) < 1) return;
    const view = under.view();
    time.zoom(view, Math.abs(from - still) / Math.abs(to - still), timeAt(still, view), under.now());
  }

  function leave(event: PointerEvent) {
    if (event.pointerType === 'mouse' && pressed === null) time.ago = null;
  }

  function wheel(event: WheelEvent) {
    event.preventDefault();
    const view = under.view();
    const sideways = event.shiftKey ? event.deltaY : event.deltaX;
    if (Math.abs(sideways) > Math.abs(event.shiftKey ? 0 : event.deltaY)) {
      time.move(view, (sideways / Math.max(node.clientWidth, 1)) * view.seconds, under.now());
    } else if (event.deltaY !== 0) {
      time.zoom(view, Math.exp(event.deltaY * WHEEL), timeAt(event.clientX, view), under.now());
      point(event.clientX);
    }
  }

  function key(event: KeyboardEvent) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.shiftKey && event.key !== '+') return;
    if (!press(event.key)) return;
    event.preventDefault();
  }

  function press(name: string): boolean {
    const view = under.view();
    const now = under.now();
    const seconds = view.seconds;
    const around = view.end - (time.ago ?? seconds / 2);
    const cursor = (ago: number) => (time.ago = Math.min(Math.max(ago, 0), seconds));
    if (name === 'ArrowLeft') cursor((time.ago ?? 0) + seconds * KEY_STEP);
    else if (name === 'ArrowRight') cursor((time.ago ?? 0) - seconds * KEY_STEP);
    else if (name === 'Home') cursor(seconds);
    else if (name === 'End') cursor(0);
    else if (name === 'PageUp') time.move(view, -seconds * KEY_MOVE, now);
    else if (name === 'PageDown') time.move(view, seconds * KEY_MOVE, now);
    else if (name === '+' || name === '=') time.zoom(view, KEY_ZOOM, around, now);
    else if (name === '-') time.zoom(view, 1 / KEY_ZOOM, around, now);
    else if (name === '0') time.resume();
    else if (name === 'p') time.toggle(now);
    else return false;
    return true;
  }

  const blur = () => (time.ago = null);
  const listeners: [string, (event: never) => void, AddEventListenerOptions?][] = [
    ['pointerdown', down],
    ['pointermove', move],
    ['pointerup', up],
    ['pointercancel', up],
    ['pointerleave', leave],
    ['wheel', wheel, { passive: false }],
    ['dblclick', time.resume],
    ['keydown', key],
    ['blur', blur],
  ];
  for (const [name, call, options] of listeners) node.addEventListener(name, call as EventListener, options);
  return () => {
    for (const [name, call] of listeners) node.removeEventListener(name, call as EventListener);
  };
}
