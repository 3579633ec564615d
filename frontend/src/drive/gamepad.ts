import type { Axis, Push } from './axes';

/** A gamepad at one moment, as far as it is read. */
export type Pad = Pick<Gamepad, 'axes' | 'buttons'>;

/** What a button of a gamepad can do, beside moving an axis of the robot. */
export const BUTTONS = ['stop', 'depth', 'heading', 'slower', 'faster', 'snapshot', 'flight'] as const;
export type Button = (typeof BUTTONS)[number];

/** An axis of the gamepad that moves one of the robot's. */
export interface StickAxis {
  readonly index: number;
  readonly invert: boolean;
  /** where it stands when nobody touches it: a stick in the middle, a trigger at one of its ends */
  readonly rest: -1 | 0 | 1;
  /** share of the way within which it counts as at rest */
  readonly dead: number;
  /** 0: straight; 1: fine near rest */
  readonly curve: number;
}

/** What moves one axis of the robot: an axis of the gamepad, and a button for each direction. */
export interface Motion {
  readonly stick: StickAxis | null;
  readonly less: number | null;
  readonly more: number | null;
}

/** Assignments of a gamepad. */
export interface PadProfile {
  /** of x, y, z, roll, pitch and yaw */
  readonly motions: readonly Motion[];
  readonly buttons: Readonly<Record<Button, number | null>>;
}

/** Of a stick that nobody has set otherwise. Worn sticks rest as far as 0.19 from the middle. */
export const DEAD = 0.2;
export const DEAD_MOST = 0.9;

const stick = (index: number, invert = false): Motion => ({ stick: { index, invert, rest: 0, dead: DEAD, curve: 0 }, less: null, more: null });
const cross = (less: number, more: number): Motion => ({ stick: null, less, more });

/** For the "standard" layout of the Gamepad API. As on the screen: the left stick lifts and turns. */
export const STANDARD: PadProfile = {
  motions: [stick(3, true), stick(2), stick(1), cross(14, 15), cross(13, 12), stick(0)],
  buttons: { stop: 1, depth: 2, heading: 3, slower: 4, faster: 5, snapshot: 0, flight: 9 },
};

export const UNASSIGNED: PadProfile = {
  motions: STANDARD.motions.map(() => ({ stick: null, less: null, more: null })),
  buttons: { stop: null, depth: null, heading: null, slower: null, faster: null, snapshot: null, flight: null },
};

/** How far an axis is from its rest, -1 to 1; 0 where the gamepad gives no number. */
export function deflection({ axes }: Pad, { index, rest }: StickAxis): number {
  const value = axes[index] ?? NaN;
  if (!Number.isFinite(value)) return 0;
  return Math.min(1, Math.max(-1, rest === 0 ? value : (value - rest) / 2));
}

/** Command of an axis: 0 within the dead zone, growing from nothing beyond it. */
export function amountOf(pad: Pad, axis: StickAxis): number {
  const way = deflection(pad, axis);
  const far = Math.abs(way);
  if (far <= axis.dead) return 0;
  const share = (far - axis.dead) / (1 - axis.dead);
  return Math.sign(way) * (axis.invert ? -1 : 1) * ((1 - axis.curve) * share + axis.curve * share ** 3);
}

const isDown = ({ buttons }: Pad, index: number | null): boolean => index !== null && (buttons[index]?.pressed ?? false);

/** Pushes of the gamepad; none where everything that moves the robot rests. */
export function pushesOf(pad: Pad, { motions }: PadProfile): Push[] {
  return motions.flatMap((motion, axis) => {
    const buttons = Number(isDown(pad, motion.more)) - Number(isDown(pad, motion.less));
    const amount = (motion.stick === null ? 0 : amountOf(pad, motion.stick)) + buttons;
    return amount === 0 ? [] : [{ axis: axis as Axis, amount }];
  });
}

export const downOf = (pad: Pad, { buttons }: PadProfile): Button[] => BUTTONS.filter((name) => isDown(pad, buttons[name]));

/** The name without the numbers that browsers add for programs; '' where there is none. */
export const shortName = (id: string): string =>
  id
    .replace(/\s*\(.*$/, '')
    .replace(/^[0-9a-f]{4}-[0-9a-f]{4}-/i, '')
    .trim();
