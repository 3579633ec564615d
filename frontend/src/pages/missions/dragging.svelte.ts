import { createContext } from 'svelte';
import type { Path, Place } from './cards';
import type { MissionEditing } from './editing.svelte';

/** px from the edge of the page within which it scrolls while something is dragged */
const EDGE = 48;
const SCROLL_PX = 14;

const readPath = (text: string): Path => (text === '' ? [] : text.split('.').map((one) => Number(one) - 1));

/** A step that is dragged by a pointer, to the place that it is over. */
export class StepDrag {
  /** null while nothing is dragged */
  from = $state.raw<Path | null>(null);
  /** null where it cannot be put */
  over = $state.raw<Place | null>(null);

  constructor(private readonly editing: MissionEditing) {}

  begin(event: PointerEvent & { currentTarget: HTMLElement }, path: Path): void {
    if (event.button !== 0 || this.editing.locked) return;
    event.currentTarget.setPointerCapture(event.pointerId);
    this.from = path;
    this.over = null;
  }

  move(event: PointerEvent & { currentTarget: HTMLElement }): void {
    if (this.from === null) return;
    this.over = this.#placeAt(event.clientX, event.clientY);
    const page = event.currentTarget.closest('main');
    const box = page?.getBoundingClientRect();
    if (!page || !box) return;
    if (event.clientY < box.top + EDGE) page.scrollBy(0, -SCROLL_PX);
    if (event.clientY > box.bottom - EDGE) page.scrollBy(0, SCROLL_PX);
  }

  drop(): void {
    const { from, over } = this;
    this.cancel();
    if (from !== null && over !== null) void this.editing.moveTo(from, over);
  }

  cancel(): void {
    this.from = null;
    this.over = null;
  }

  /** Before or after the card there, by its halves; at the end of a list over what adds to it. */
  #placeAt(x: number, y: number): Place | null {
    const element = document.elementFromPoint(x, y)?.closest<HTMLElement>('[data-drop]');
    if (!element) return null;
    const path = readPath(element.dataset.drop ?? '');
    if (element.dataset.end !== undefined) return this.#allowed({ parent: path, index: Number(element.dataset.end) });
    const index = path.at(-1);
    if (index === undefined) return this.#allowed({ parent: [], index: 0 });
    const { top, height } = element.getBoundingClientRect();
    return this.#allowed({ parent: path.slice(0, -1), index: y < top + height / 2 ? index : index + 1 });
  }

  #allowed(place: Place): Place | null {
    return this.from !== null && this.editing.canMoveTo(this.from, place) ? place : null;
  }
}

export const [useDrag, provideDrag] = createContext<StepDrag>();
