/** Every number of every topic of rows, as something that a chart can show. */
import { ROW_TOPICS, type Field, type Rows } from '../generated/topics';
import type { ChoiceGroup } from '../parts/choices';
import { charts as texts } from '../texts/charts';

export interface Signal {
  /** as recordings and exports call it: `depth.depth`, or `motor.angle_2` where a field holds several */
  readonly name: string;
  readonly topic: keyof Rows;
  readonly field: string;
  /** which of several; 0 where the field holds one */
  readonly element: number;
  /** in words, without the topic */
  readonly label: string;
  readonly unit: string;
  /** how many are written, so that the smallest difference shows */
  readonly decimals: number;
  readonly meaning: string;
  /** what is wanted rather than measured: drawn dashed */
  readonly wanted: boolean;
  /** a depth, which is drawn downwards */
  readonly downwards: boolean;
  /** after π comes -π */
  readonly angle: boolean;
}

const QUATERNION = ['w', 'x', 'y', 'z'];
/** Names of the elements of a field; those of other fields are numbered. */
const ELEMENTS: Readonly<Record<string, readonly string[]>> = {
  'imu.attitude': QUATERNION,
  'imu.rate': ['x', 'y', 'z'],
  'imu.force': ['x', 'y', 'z'],
  'motor.wanted': texts.fins,
  'motor.angle': texts.fins,
  'motor.drive': texts.fins,
  'truth.position': texts.directions,
  'truth.attitude': QUATERNION,
  'truth.velocity': ['x', 'y', 'z'],
  'truth.rate': ['x', 'y', 'z'],
  'truth.fins': texts.fins,
};
const DEPTHS: ReadonlySet<string> = new Set(['depth.depth', 'control.set_point', 'control.depth', 'truth.position_2']);
const DECIMALS_MOST = 4;
const WANTED = /^(wanted|set_point)|_set_point$/;

function decimalsOf({ code, scale }: Field): number {
  if (code === 'f' || code === 'd') return DECIMALS_MOST - 1;
  return Math.min(DECIMALS_MOST, Math.max(0, Math.ceil(-Math.log10(scale) - 1e-9)));
}

function signalsOf(topic: keyof Rows, field: Field): Signal[] {
  const words = field.name.replaceAll('_', ' ');
  return Array.from({ length: field.count }, (_, element) => {
    const name = `${topic}.${field.name}${field.count > 1 ? `_${element}` : ''}`;
    const place = ELEMENTS[`${topic}.${field.name}`]?.[element] ?? String(element);
    return {
      name,
      topic,
      field: field.name,
      element,
      label: field.count > 1 ? texts.element(words, place) : words,
      unit: field.unit,
      decimals: decimalsOf(field),
      meaning: field.meaning,
      wanted: WANTED.test(field.name),
      downwards: DEPTHS.has(name),
      angle: field.unit === 'rad',
    };
  });
}

const TOPICS = Object.keys(ROW_TOPICS) as (keyof Rows)[];

export const SIGNALS: readonly Signal[] = TOPICS.flatMap((topic) =>
  ROW_TOPICS[topic].fields.flatMap((field: Field) => signalsOf(topic, field)),
);

const BY_NAME = new Map(SIGNALS.map((signal) => [signal.name, signal]));

/** The signal of this name; null where this version has none. */
function findSignal(name: string): Signal | null {
  return BY_NAME.get(name) ?? null;
}

/** The signals of these names; what this version does not have is left out. */
export function findSignals(names: readonly string[]): Signal[] {
  return names.map(findSignal).filter((signal) => signal !== null);
}

/** Signals that a live chart may show. */
export const GROUPS: readonly ChoiceGroup[] = TOPICS.map((topic) => ({
  topic,
  meaning: ROW_TOPICS[topic].meaning,
  choices: SIGNALS.filter((signal) => signal.topic === topic),
}));
