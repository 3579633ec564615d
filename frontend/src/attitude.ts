/** Angles of the body, rad. */
interface Euler {
  /** right side down */
  readonly roll: number;
  /** nose up */
  readonly pitch: number;
  /** to the right, from north */
  readonly yaw: number;
}

/** The angles, in the order yaw, pitch, roll, of a unit quaternion w, x, y, z that turns body into world. */
export function euler(quaternion: readonly number[]): Euler {
  const [w = 1, x = 0, y = 0, z = 0] = quaternion;
  const sine = 2 * (w * y - z * x);
  return {
    roll: Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    // Rounding on the wire may take the sine a little beyond 1.
    pitch: Math.asin(Math.min(1, Math.max(-1, sine))),
    yaw: Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  };
}

export const degrees = (radians: number): number => (radians * 180) / Math.PI;
