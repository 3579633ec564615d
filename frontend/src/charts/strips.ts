/** Which signals share a y axis: a chart has one strip for each, one below the other over one axis of time. */
import type { Signal } from './signals';

export interface Strip {
  readonly key: string;
  readonly unit: string;
  readonly downwards: boolean;
  readonly traces: readonly Trace[];
}

interface Trace {
  readonly signal: Signal;
  /** name of a colour in styles/tokens.css; each strip begins anew */
  readonly colour: string;
}

/** Most signals in one chart: more than this nobody tells apart. */
export const MOST = 12;
/** names in styles/tokens.css, after Okabe and Ito */
const COLOURS = ['series-measured', 'series-wanted', 'series-third', 'series-4', 'series-5', 'series-6', 'series-7'];

/** Signals of one unit lie together, and depths by themselves; what has no unit only with its own topic. */
export function stripsOf(signals: readonly Signal[]): Strip[] {
  const strips = new Map<string, { unit: string; downwards: boolean; traces: Trace[] }>();
  for (const signal of signals) {
    const key = signal.downwards ? 'depth' : signal.unit === '' ? `of ${signal.topic}` : signal.unit;
    const strip = strips.get(key) ?? { unit: signal.unit, downwards: signal.downwards, traces: [] };
    strip.traces.push({ signal, colour: COLOURS[strip.traces.length % COLOURS.length] ?? 'text' });
    strips.set(key, strip);
  }
  return [...strips].map(([key, strip]) => ({ key, ...strip }));
}
