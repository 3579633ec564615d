import type { ScenarioEvent } from '../../api';
import { scenarios as texts } from '../../texts/scenarios';

/** Whose doing an event is; each has a shape and a colour of its own. */
export type Sort = 'operator' | 'water' | 'fault' | 'marker';

const SORTS: Readonly<Record<string, Sort>> = {
  beacons: 'water',
  current: 'water',
  waves: 'water',
  trim: 'water',
  fault: 'fault',
  line: 'fault',
  marker: 'marker',
};

export const LEGEND: readonly { readonly sort: Sort; readonly words: string }[] = [
  { sort: 'operator', words: texts.legend.operator },
  { sort: 'water', words: texts.legend.water },
  { sort: 'fault', words: texts.legend.fault },
  { sort: 'marker', words: texts.legend.bookmark },
];

export const sortBy = (kind: string): Sort => SORTS[kind] ?? 'operator';
export const sortOf = (event: ScenarioEvent): Sort => sortBy(event.do);

/** s of a scenario, as short as they can be said */
export const moment = (seconds: number): string => `${Number(seconds.toFixed(1))} s`;

/** The outline of a sort's mark about (0, 0), 10 px wide. */
export const SHAPES: Readonly<Record<Sort, string>> = {
  operator: 'M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0',
  water: 'M0-5L5 0L0 5L-5 0Z',
  fault: 'M0-5L5 4H-5Z',
  marker: 'M-4-4H4V4H-4Z',
};
