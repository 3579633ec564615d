import type { State } from '../generated/topics';
import { YAW, Z, type Axis } from './axes';

/** The loops that hold while the robot is driven by hand, and the pilot's axis that each takes. */
const AXIS_OF = { depth: Z, heading: YAW } as const satisfies Record<string, Axis>;
export type Holdable = keyof typeof AXIS_OF;
export const HOLDABLE = Object.keys(AXIS_OF) as Holdable[];

export const loopOf = (state: State | null, name: Holdable) => state?.loops.find((loop) => loop.name === name) ?? null;

/** whether the robot holds this axis by itself */
export const keeps = (state: State | null, axis: Axis): boolean =>
  HOLDABLE.some((name) => AXIS_OF[name] === axis && loopOf(state, name)?.on === true);
