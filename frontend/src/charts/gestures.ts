import type { ChartTime } from './time.svelte';
import { viewUntil, type View } from './view';

/** The chart over which pointers, wheel and keys are. */
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
  const gestures = new Gestures(node, under);
  const listeners: [string, (event: never) => void, AddEventListenerOptions?][] = [
    ['pointerdown', gestures.down],
    ['pointermove', gestures.move],
    ['pointerup', gestures.up],
    ['pointercancel', gestures.up],
    ['pointerleave', gestures.leave],
    ['wheel', gestures.wheel, { passive: false }],
    ['dblclick', under.time.resume],
    ['keydown', gestures.key],
    ['blur', gestures.blur],
  ];
  for (const [name, call, options] of listeners) node.addEventListener(name, call as EventListener, options);
  return () => {
    for (const [name, call] of listeners) node.removeEventListener(name, call as EventListener);
  };
}

/** Has pointers, wheel and keys move the chart over which they are. */
class Gestures {
  /** x of each pointer that is down, px */
  readonly #pointers = new Map<number, number>();
  #pressed: { at: number; view: View; moves: boolean } | null = null;
  #dragged = false;
  readonly #time: ChartTime;

  constructor(
    private readonly node: HTMLElement,
    private readonly under: Under,
  ) {
    this.#time = under.time;
  }

  readonly down = (event: PointerEvent): void => {
    if (event.pointerType === 'mouse' && event.button !== 0) return;
    this.#pointers.set(event.pointerId, event.clientX);
    this.node.setPointerCapture(event.pointerId);
    this.#dragged = false;
    if (event.pointerType !== 'mouse') this.#point(event.clientX);
    else this.#pressed = { at: event.clientX, view: this.under.view(), moves: event.shiftKey };
  };

  readonly move = (event: PointerEvent): void => {
    const before = this.#pointers.get(event.pointerId);
    if (this.#pointers.size === 2 && before !== undefined) this.#pinch(event.pointerId, before, event.clientX);
    else this.#point(event.clientX);
    if (before !== undefined) this.#pointers.set(event.pointerId, event.clientX);
    if (this.#pressed !== null) this.#drag(this.#pressed, event.clientX);
  };

  readonly up = (event: PointerEvent): void => {
    this.#pointers.delete(event.pointerId);
    const pressed = this.#pressed;
    if (pressed !== null && this.#dragged && !pressed.moves && event.type === 'pointerup') {
      const [start, end] = inOrder(this.#timeAt(pressed.at), this.#timeAt(event.clientX));
      this.#time.show(viewUntil(end, end - start), this.under.now());
    }
    this.#pressed = null;
    this.under.select(null);
  };

  readonly leave = (event: PointerEvent): void => {
    if (event.pointerType === 'mouse' && this.#pressed === null) this.blur();
  };

  readonly blur = (): void => {
    this.#time.ago = null;
  };

  readonly wheel = (event: WheelEvent): void => {
    event.preventDefault();
    const view = this.under.view();
    const sideways = event.shiftKey ? event.deltaY : event.deltaX;
    if (Math.abs(sideways) > Math.abs(event.shiftKey ? 0 : event.deltaY)) {
      this.#time.move(view, (sideways / Math.max(this.node.clientWidth, 1)) * view.seconds, this.under.now());
    } else if (event.deltaY !== 0) {
      this.#time.zoom(view, Math.exp(event.deltaY * WHEEL), this.#timeAt(event.clientX), this.under.now());
      this.#point(event.clientX);
    }
  };

  readonly key = (event: KeyboardEvent): void => {
    if (event.ctrlKey || event.metaKey || event.altKey || (event.shiftKey && event.key !== '+')) return;
    const act = this.#actions()[event.key];
    if (act === undefined) return;
    act();
    event.preventDefault();
  };

  #actions(): Readonly<Record<string, () => void>> {
    const time = this.#time;
    const view = this.under.view();
    const { seconds } = view;
    const now = this.under.now();
    const around = view.end - (time.ago ?? seconds / 2);
    const cursor = (ago: number) => (time.ago = Math.min(Math.max(ago, 0), seconds));
    const zoomIn = () => time.zoom(view, KEY_ZOOM, around, now);
    return {
      ArrowLeft: () => cursor((time.ago ?? 0) + seconds * KEY_STEP),
      ArrowRight: () => cursor((time.ago ?? 0) - seconds * KEY_STEP),
      Home: () => cursor(seconds),
      End: () => cursor(0),
      PageUp: () => time.move(view, -seconds * KEY_MOVE, now),
      PageDown: () => time.move(view, seconds * KEY_MOVE, now),
      '+': zoomIn,
      '=': zoomIn,
      '-': () => time.zoom(view, 1 / KEY_ZOOM, around, now),
      '0': time.resume,
      p: () => time.toggle(now),
    };
  }

  #drag(pressed: { at: number; view: View; moves: boolean }, x: number): void {
    this.#dragged ||= Math.abs(x - pressed.at) >= DRAG;
    if (!this.#dragged) return;
    if (!pressed.moves) this.under.select(inOrder(this.#share(pressed.at), this.#share(x)));
    else this.#time.move(pressed.view, this.#timeAt(pressed.at, pressed.view) - this.#timeAt(x, pressed.view), this.under.now());
  }

  /** Both fingers stay over the moments that they touched. */
  #pinch(moving: number, from: number, to: number): void {
    const still = [...this.#pointers].find(([pointer]) => pointer !== moving)?.[1];
    if (still === undefined || Math.abs(to - still) < 1) return;
    const factor = Math.abs(from - still) / Math.abs(to - still);
    this.#time.zoom(this.under.view(), factor, this.#timeAt(still), this.under.now());
  }

  #share(x: number): number {
    const { left, width } = this.node.getBoundingClientRect();
    return Math.min(Math.max((x - left) / Math.max(width, 1), 0), 1);
  }

  #timeAt(x: number, view = this.under.view()): number {
    return view.start + this.#share(x) * view.seconds;
  }

  #point(x: number): void {
    this.#time.ago = (1 - this.#share(x)) * this.under.view().seconds;
  }
}

const inOrder = (one: number, other: number): [number, number] => (one < other ? [one, other] : [other, one]);
