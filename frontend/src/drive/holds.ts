import { YAW, Z, type Axis } from './axes';

/** The loops that hold while the robot is driven by hand, and the pilot's axis that each takes. */
export const AXIS_OF = { depth: Z, heading: YAW } as const satisfies Record<string, Axis>;
export type Holdable = keyof typeof AXIS_OF;
