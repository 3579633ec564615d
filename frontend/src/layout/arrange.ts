/**
 * Changes of a layout. Each answers the panels as they then stand, or why it cannot be, in words.
 *
 * No panel ever lies over another: one that is moved onto another changes places with it, and one that grows into
 * another takes its room, down to the least size of that one.
 */
import type { Size } from '../parts/panelKind';
import { COLUMNS, overlaps, PANELS_MOST, ROWS_MOST, ROWS_SEEN, rowsOf, within, type Placed, type Rect } from './layout';
import { layout as texts } from '../texts/layout';

export type Arranged = { readonly panels: readonly Placed[]; readonly message: string } | { readonly refused: string };

/** Properties of a panel that the rules need. */
export type Known = (panel: string) => { readonly title: string; readonly least: Size };

export class Arranger {
  constructor(private readonly known: Known) {}

  /** Move a panel by so many columns and rows; into another one it changes places with that. */
  move(panels: readonly Placed[], id: string, columns: number, rows: number): Arranged {
    const moved = find(panels, id);
    const target = { ...moved, x: moved.x + columns, y: moved.y + rows };
    if (!within(target)) return { refused: texts.refused.edge(this.#title(moved)) };
    const met = panels.filter((one) => one.id !== id && overlaps(one, target));
    const [other] = met.sort((one, two) => shared(two, target) - shared(one, target));
    if (other === undefined) return this.#place(panels, target);
    return this.swap(panels, id, other.id);
  }

  /** Let two panels change places. */
  swap(panels: readonly Placed[], id: string, other: string): Arranged {
    const one = find(panels, id);
    const two = find(panels, other);
    for (const [panel, rect] of [[one, two], [two, one]] as const) {
      if (!this.#fits(panel, rect)) return { refused: texts.refused.tooSmall(this.#title(panel)) };
    }
    const changed = panels.map((panel) =>
      panel.id === id ? { ...panel, ...rectOf(two) } : panel.id === other ? { ...panel, ...rectOf(one) } : panel,
    );
    return { panels: changed, message: texts.done.swapped(this.#title(one), this.#title(two)) };
  }

  /** Give a panel these edges, which takes from others what they can spare. */
  resize(panels: readonly Placed[], id: string, wanted: Rect): Arranged {
    const before = find(panels, id);
    const target = { ...before, ...rectOf(wanted) };
    if (!within(target)) return { refused: texts.refused.edge(this.#title(target)) };
    if (!this.#fits(before, target)) return { refused: texts.refused.smallest(this.#title(target)) };
    const changed: Placed[] = [];
    for (const panel of panels) {
      if (panel.id === id) changed.push(target);
      else if (!overlaps(panel, target)) changed.push(panel);
      else {
        const rest = { ...panel, ...cut(panel, before, target) };
        if (!this.#fits(panel, rest) || overlaps(rest, target)) return { refused: texts.refused.smallest(this.#title(panel)) };
        changed.push(rest);
      }
    }
    return { panels: changed, message: texts.done.resized(this.#title(target), sizeWords(target)) };
  }

  /** Stand a new panel where there is room: of this size, smaller, or below all others. */
  add(panels: readonly Placed[], added: Omit<Placed, keyof Rect>, size: Size): Arranged {
    if (panels.length >= PANELS_MOST) return { refused: texts.refused.most(PANELS_MOST) };
    const { least } = this.known(added.panel);
    const rows = rowsOf(panels);
    const rect =
      free(panels, size, ROWS_SEEN) ?? free(panels, least, ROWS_SEEN) ?? free(panels, size, Math.min(ROWS_MOST, rows + size.height));
    if (rect === null) return { refused: texts.refused.full };
    return this.#place([...panels, { ...added, ...rect }], { ...added, ...rect });
  }

  remove(panels: readonly Placed[], id: string): Arranged {
    return { panels: panels.filter((one) => one.id !== id), message: texts.done.removed(this.#title(find(panels, id))) };
  }

  #place(panels: readonly Placed[], target: Placed): Arranged {
    const changed = panels.map((one) => (one.id === target.id ? target : one));
    return { panels: changed, message: texts.done.moved(this.#title(target), placeWords(target)) };
  }

  #title(panel: Placed): string {
    return this.known(panel.panel).title;
  }

  /** True where so much room is enough; what is smaller already need not become larger. */
  #fits(panel: Placed, { width, height }: Size): boolean {
    const { least } = this.known(panel.panel);
    return width >= Math.min(least.width, panel.width) && height >= Math.min(least.height, panel.height);
  }
}

export const placeWords = ({ x, y }: Rect): string => texts.place(x + 1, y + 1);
export const sizeWords = ({ width, height }: Size): string => texts.size(width, height);

function find(panels: readonly Placed[], id: string): Placed {
  const found = panels.find((one) => one.id === id);
  if (found === undefined) throw new RangeError(`no panel ${id}`);
  return found;
}

const rectOf = ({ x, y, width, height }: Rect): Rect => ({ x, y, width, height });

/** Number of cells that both take. */
function shared(one: Rect, other: Rect): number {
  const wide = Math.min(one.x + one.width, other.x + other.width) - Math.max(one.x, other.x);
  const high = Math.min(one.y + one.height, other.y + other.height) - Math.max(one.y, other.y);
  return Math.max(0, wide) * Math.max(0, high);
}

/** The rest of `panel` on its side of what grew from `before` to `after`. */
function cut(panel: Rect, before: Rect, after: Rect): Rect {
  const right = panel.x + panel.width;
  const bottom = panel.y + panel.height;
  if (panel.x >= before.x + before.width) return { ...panel, x: after.x + after.width, width: right - after.x - after.width };
  if (right <= before.x) return { ...panel, width: after.x - panel.x };
  if (panel.y >= before.y + before.height) return { ...panel, y: after.y + after.height, height: bottom - after.y - after.height };
  return { ...panel, height: after.y - panel.y };
}

/** The first free room of this size within so many rows, row by row. */
function free(panels: readonly Rect[], { width, height }: Size, rows: number): Rect | null {
  for (let y = 0; y + height <= rows; y += 1) {
    for (let x = 0; x + width <= COLUMNS; x += 1) {
      const rect = { x, y, width, height };
      if (!panels.some((one) => overlaps(one, rect))) return rect;
    }
  }
  return null;
}
