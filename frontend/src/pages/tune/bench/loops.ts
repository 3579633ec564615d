/** The robot's loops as people tune them: depths in m, angles in degrees. */
import type { LoopName } from '../../../api';
import { tune as texts } from '../../../texts/tune';

export interface Loop {
  readonly name: LoopName;
  readonly title: string;
  readonly unit: string;
  /** what one of the loop's own unit is in the shown one */
  readonly factor: number;
  /** of set points, in the shown unit */
  readonly least: number;
  readonly most: number;
  readonly decimals: number;
  /** values grow downwards in charts */
  readonly downwards: boolean;
}

const DEGREES = 180 / Math.PI;
const angle = { unit: '°', factor: DEGREES, decimals: 1, downwards: false } as const;

const DEPTH: Loop = { name: 'depth', title: texts.loops.depth, unit: 'm', factor: 1, least: 0, most: 10, decimals: 2, downwards: true };

export const LOOPS: readonly Loop[] = [
  DEPTH,
  { name: 'heading', title: texts.loops.heading, least: -180, most: 180, ...angle },
  // Of the robot's ±0.5 rad.
  { name: 'pitch', title: texts.loops.pitch, least: -28, most: 28, ...angle },
  { name: 'roll', title: texts.loops.roll, least: -28, most: 28, ...angle },
];

/** The loop of this name; the depth where there is none. */
export function loopOf(name: string | undefined): Loop {
  return LOOPS.find((one) => one.name === name) ?? DEPTH;
}
