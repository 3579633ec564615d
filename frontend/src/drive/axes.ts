/** A pilot's command to the robot: x, y, z, roll, pitch and yaw, each -1 to 1, in body axes (forward, right, down). */
export type Axes = readonly [number, number, number, number, number, number];
export type Axis = 0 | 1 | 2 | 3 | 4 | 5;

export const NEUTRAL: Axes = [0, 0, 0, 0, 0, 0];
export const [X, Y, Z, ROLL, PITCH, YAW] = [0, 1, 2, 3, 4, 5] as const;

/** One axis, towards one of its ends. */
export interface Push {
  readonly axis: Axis;
  readonly amount: number;
}

export const isNeutral = (axes: Axes): boolean => axes.every((value) => value === 0);

const within = (value: number): number => Math.min(1, Math.max(-1, value));

/** Everything that is held, together; opposites cancel out. */
export function combine(held: Iterable<readonly Push[]>): Axes {
  const sum: number[] = [...NEUTRAL];
  for (const pushes of held) for (const { axis, amount } of pushes) sum[axis] = (sum[axis] ?? 0) + amount;
  return sum.map(within) as unknown as Axes;
}

/**
 * Command of the sticks at this share of full speed, with the trim; neutral where they are in the middle.
 *
 * @param kept whether the robot holds this axis by itself: then only the stick moves it
 */
export function driven(sticks: Axes, share: number, trim: Axes, kept: (axis: Axis) => boolean): Axes {
  if (isNeutral(sticks)) return NEUTRAL;
  return sticks.map((value, axis) => {
    const own = value === 0 && kept(axis as Axis) ? 0 : (trim[axis] ?? 0);
    return within(value * share + own);
  }) as unknown as Axes;
}

/** Go from `now` towards `wanted` by at most `step` on each axis; back towards neutral, at once. */
export function approach(now: Axes, wanted: Axes, step: number): Axes {
  return wanted.map((goal, axis) => {
    const value = now[axis] ?? 0;
    const from = Math.sign(value) === Math.sign(goal) ? value : 0;
    return Math.abs(goal) <= Math.abs(from) ? goal : from + Math.sign(goal) * Math.min(step, Math.abs(goal - from));
  }) as unknown as Axes;
}
