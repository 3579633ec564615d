/** Which signals share a chart, and how they are drawn in it. */
import type { Signal } from '../../../api';
import type { ChoiceGroup } from '../../../parts/choices';
import { compare as texts } from '../../../texts/compare';

interface ChartSignal {
  readonly signal: Signal;
  /** wanted, not measured: drawn dashed */
  readonly wanted: boolean;
}

export interface Chart {
  readonly title: string;
  readonly unit: string;
  /** values grow downwards */
  readonly downwards: boolean;
  readonly signals: readonly ChartSignal[];
}

interface Preset {
  readonly name: string;
  readonly hint: string;
  readonly signals: readonly string[];
}

export const DEPTH = 'depth.depth';
const SET_POINT = 'control.set_point';

export const PRESETS: readonly Preset[] = [
  { ...texts.presets.depth, signals: [DEPTH, SET_POINT] },
  {
    ...texts.presets.thesis,
    signals: [DEPTH, SET_POINT, 'control.error', 'navigation.z', 'detection.area'],
  },
  {
    ...texts.presets.fins,
    signals: [0, 1, 2, 3].flatMap((fin) => [`motor.angle_${fin}`, `motor.wanted_${fin}`]),
  },
];

/** Signals that are drawn downwards. */
export const DEPTHS = new Set([
  DEPTH,
  SET_POINT,
  'control.depth',
  'state.set_point',
  'state.set_point_default',
  'state.set_point_detected',
  'truth.position_2',
]);
const TITLES: Readonly<Record<string, string>> = {
  'control.error': texts.charts.depthError,
  'control.output': texts.charts.command,
  'navigation.z': texts.charts.command,
  'detection.area': texts.charts.colourArea,
  'detection.seen': texts.charts.colour,
  'status.battery': texts.charts.battery,
};

/** The charts of these signals, from top to bottom in the order in which they were chosen. */
export function chartsOf(signals: readonly Signal[]): Chart[] {
  const charts = new Map<string, { title: string; unit: string; downwards: boolean; signals: ChartSignal[] }>();
  for (const signal of signals) {
    const title = titleOf(signal);
    const key = `${title} ${signal.unit}`;
    const chart = charts.get(key) ?? { title, unit: signal.unit, downwards: DEPTHS.has(signal.name), signals: [] };
    chart.signals.push({ signal, wanted: isWanted(signal) });
    charts.set(key, chart);
  }
  return [...charts.values()];
}

/** The signals of all sessions together, by topic; of those that not every session has it is said. */
export function gather(lists: readonly (readonly Signal[])[]): ChoiceGroup[] {
  const found = new Map(lists.flat().map((signal) => [signal.name, signal]));
  const topics = new Set([...found.values()].map(({ topic }) => topic));
  return [...topics].map((topic) => ({
    topic,
    meaning: '',
    choices: [...found.values()]
      .filter((signal) => signal.topic === topic)
      .map(({ name, column, unit, meaning }) => {
        const having = lists.filter((list) => list.some((signal) => signal.name === name)).length;
        const note = having < lists.length ? { note: texts.signals.inSessions(having, lists.length) } : {};
        return { name, label: columnWords(column), unit, meaning, ...note };
      }),
  }));
}

/** A signal in words, such as "angle 2". */
export function columnWords(column: string): string {
  return column.replaceAll('_', ' ');
}

function titleOf({ name, topic, column, meaning }: Signal): string {
  if (DEPTHS.has(name)) return texts.charts.depth;
  const fin = /^(angle|wanted|drive)_([0-3])$/.exec(column);
  if (topic === 'motor' && fin) return texts.charts[fin[1] === 'drive' ? 'drive' : 'fin'](texts.charts.fins[Number(fin[2])] ?? '');
  return TITLES[name] ?? `${capital(columnWords(column))}, ${topic}${meaning ? `: ${meaning}` : ''}`;
}

function isWanted({ column }: Signal): boolean {
  return /^(set_point|wanted)/.test(column);
}

function capital(words: string): string {
  return words.charAt(0).toUpperCase() + words.slice(1);
}
