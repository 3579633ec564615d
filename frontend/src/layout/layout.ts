/** Where the panels of Operate stand: a document that the server keeps (server/features/layouts/document.py) and files hold. */

import { MOST } from '../charts/strips';
import type { ShownChart } from '../parts/panelKind';
import { layout as texts } from '../texts/layout';

export const FORMAT = 'mucat-layout';
export const VERSION = 1;
/** The grid is as wide as the screen lets it be; so many rows fill its height, and more are scrolled to. */
export const COLUMNS = 24;
export const ROWS_SEEN = 24;
export const ROWS_MOST = 96;
export const PANELS_MOST = 40;

/** In columns and rows, from the grid's upper left corner. */
export interface Rect {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export interface Placed extends Rect {
  /** tells it from others of its kind */
  readonly id: string;
  /** its name in registry.ts, or `own/NAME` */
  readonly panel: string;
  readonly chart?: ShownChart;
}

export interface Layout {
  readonly format: typeof FORMAT;
  readonly version: typeof VERSION;
  readonly panels: readonly Placed[];
}

export function overlaps(one: Rect, other: Rect): boolean {
  return (
    one.x < other.x + other.width &&
    other.x < one.x + one.width &&
    one.y < other.y + other.height &&
    other.y < one.y + one.height
  );
}

export function within(rect: Rect): boolean {
  return rect.x >= 0 && rect.y >= 0 && rect.x + rect.width <= COLUMNS && rect.y + rect.height <= ROWS_MOST;
}

/** Rows that the layout takes; at least those of a screen. */
export function rowsOf(panels: readonly Rect[]): number {
  return Math.max(ROWS_SEEN, ...panels.map(({ y, height }) => y + height));
}

/** The layout that this text or object holds, or why it is none, in words. */
export function readLayout(given: unknown): Layout | { readonly problem: string } {
  const document = typeof given === 'string' ? parse(given) : given;
  if (!isObject(document) || document.format !== FORMAT) return { problem: texts.invalid.noLayout };
  const { version, panels } = document;
  if (version !== VERSION) {
    return { problem: texts.invalid.version(String(version).slice(0, 20), VERSION) };
  }
  if (!Array.isArray(panels) || panels.length > PANELS_MOST || !panels.every(isPlaced)) {
    return { problem: texts.invalid.unreadable };
  }
  const sound =
    new Set(panels.map(({ id }) => id)).size === panels.length &&
    panels.every(within) &&
    panels.every((one, index) => !panels.slice(index + 1).some((other) => overlaps(one, other)));
  if (!sound) return { problem: texts.invalid.overlapping };
  return { format: FORMAT, version: VERSION, panels };
}

function parse(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

const isWord = (value: unknown): value is string => typeof value === 'string' && value !== '' && value.length <= 64;
const isWhole = (value: unknown): value is number => Number.isInteger(value) && (value as number) >= 0;

function isPlaced(value: unknown): value is Placed {
  if (!isObject(value)) return false;
  const { id, panel, x, y, width, height, chart } = value;
  const placed = isWord(id) && isWord(panel) && [x, y].every(isWhole) && [width, height].every((one) => isWhole(one) && one > 0);
  return placed && (chart === undefined || isChart(chart));
}

function isChart(value: unknown): value is ShownChart {
  if (!isObject(value)) return false;
  const { signals, seconds } = value;
  const spans = typeof seconds === 'number' && seconds >= 1 && seconds <= 3600;
  if (!spans || !Array.isArray(signals) || signals.length > MOST || !signals.every(isWord)) return false;
  return new Set(signals).size === signals.length;
}
