/** A panel as the grid that it stands in sees it. */
import type { Component } from 'svelte';

/** In columns and rows of the grid. */
export interface Size {
  readonly width: number;
  readonly height: number;
}

export type Plain = Component<Record<string, never>>;

/** A panel that can be put into a layout. */
export interface PanelKind {
  readonly name: string;
  /** what its head says, too */
  readonly title: string;
  readonly about: string;
  readonly load: () => Promise<{ readonly default: Plain }>;
  readonly size: Size;
  readonly least: Size;
  /** the phone's tab that has it; none where it stands above the tabs */
  readonly tab?: 'motion' | 'sensors' | 'console' | 'events';
}

/** Signals and length of a panel of kind `chart`. */
export interface ShownChart {
  /** names of signals (charts/signals.ts) */
  readonly signals: readonly string[];
  readonly seconds: number;
}

/** climb-rate.js is “Climb rate” until its script says otherwise. */
export function ownTitle(name: string): string {
  const words = name.replaceAll(/[-_]+/g, ' ').trim();
  return words.charAt(0).toUpperCase() + words.slice(1);
}
