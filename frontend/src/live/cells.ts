import type { Cell } from '../api';

/** Cells of one run from two sources, each once, in order of number; `newer` counts where both have one. */
export function mergeCells(known: readonly Cell[], newer: readonly Cell[]): Cell[] {
  const merged = new Map([...known, ...newer].map((cell) => [cell.number, cell]));
  return [...merged.values()].sort((one, other) => one.number - other.number);
}
