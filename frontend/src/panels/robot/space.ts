/** In body axes (forward, right, down) or in the world's (north, east, down); m. */
export type Vector = readonly [number, number, number];
/** w, x, y, z, body to world */
export type Quaternion = readonly [number, number, number, number];

export const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a: Vector, b: Vector): Vector => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const minus = (a: Vector, b: Vector): Vector => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** `a` and so much of `b` */
export const along = (a: Vector, b: Vector, much: number): Vector => [a[0] + b[0] * much, a[1] + b[1] * much, a[2] + b[2] * much];

export function unit(a: Vector): Vector {
  const length = Math.sqrt(dot(a, a)) || 1;
  return [a[0] / length, a[1] / length, a[2] / length];
}

/** A vector of the body in the world. */
export function turn([w, x, y, z]: Quaternion, a: Vector): Vector {
  const axis: Vector = [x, y, z];
  const across = cross(axis, a);
  return along(along(a, across, 2 * w), cross(axis, across), 2);
}

/** A vector of the world in the body. */
export const turnBack = ([w, x, y, z]: Quaternion, a: Vector): Vector => turn([w, -x, -y, -z], a);

/** Looks at the middle of the robot from `distance`; turned by nothing but whoever drags it. */
export interface Camera {
  /** rad from north to where it stands */
  readonly azimuth: number;
  /** rad above the horizon */
  readonly elevation: number;
  /** m */
  readonly distance: number;
}

export interface Eye {
  /** where it stands, in the world */
  readonly place: Vector;
  /** where a place of the world is seen: to the right and down of the middle */
  readonly see: (place: Vector) => readonly [number, number];
}

/** in which a metre is seen at a distance of a metre */
export const FOCAL = 4;

export function eyeOf({ azimuth, elevation, distance }: Camera): Eye {
  const ahead: Vector = [-Math.cos(azimuth) * Math.cos(elevation), -Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation)];
  const right: Vector = [Math.sin(azimuth), -Math.cos(azimuth), 0];
  const down = cross(ahead, right);
  const place: Vector = [-ahead[0] * distance, -ahead[1] * distance, -ahead[2] * distance];
  return {
    place,
    see(at) {
      const seen = minus(at, place);
      const scale = FOCAL / Math.max(0.05, dot(seen, ahead));
      return [dot(seen, right) * scale, dot(seen, down) * scale];
    },
  };
}
