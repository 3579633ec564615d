import { along, cross, minus, unit, type Vector } from './space';

/** A flat piece of the robot, its corners to be seen in turn to the right from outside; body axes, m. */
export interface Facet {
  readonly corners: readonly Vector[];
  readonly normal: Vector;
  readonly part: 'shell' | 'scute' | 'belly' | 'head';
}

/** m; half of length, width and height, and how full the hull is: 2 would be an ellipsoid */
const HALF: Vector = [0.12, 0.05, 0.05];
const FULLNESS = 2.5;
const RINGS = 18;
const SIDES = 24;
const HEAD: Vector = [0.122, 0, -0.006];
const HEAD_RADIUS = 0.024;

/** A round body about the long axis, of rings whose radius (a share) and place along it are given. */
function surface(ring: (share: number) => Vector, rings: number, at: Vector, part: (ring: number, side: number) => Facet['part']): Facet[] {
  const place = (i: number, j: number): Vector => {
    const [forward, right, down] = ring(i / rings);
    const angle = (2 * Math.PI * j) / SIDES;
    return [at[0] + forward, at[1] + right * Math.cos(angle), at[2] + down * Math.sin(angle)];
  };
  const facets: Facet[] = [];
  for (let i = 0; i < rings; i += 1) {
    for (let j = 0; j < SIDES; j += 1) {
      const corners = [place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)] as const;
      const normal = unit(cross(minus(corners[2], corners[0]), minus(corners[3], corners[1])));
      facets.push({ corners, normal, part: part(i, j) });
    }
  }
  return facets;
}

/** Nose to tail; the rings stand closer where it is rounder. */
export const HULL: readonly Facet[] = surface(
  (share) => {
    const forward = Math.cos(Math.PI * share);
    const radius = (1 - Math.abs(forward) ** FULLNESS) ** (1 / FULLNESS);
    return [HALF[0] * forward, HALF[1] * radius, HALF[2] * radius];
  },
  RINGS,
  [0, 0, 0],
  (ring, side) => {
    // Down grows with the sine: the first half of the sides lies below.
    if (side < SIDES / 2) return 'belly';
    return (Math.floor(ring / 3) + Math.floor((side - SIDES / 2) / 4)) % 2 === 0 ? 'shell' : 'scute';
  },
);

export const HEAD_FACETS: readonly Facet[] = surface(
  (share) => [HEAD_RADIUS * Math.cos(Math.PI * share), HEAD_RADIUS * Math.sin(Math.PI * share), HEAD_RADIUS * Math.sin(Math.PI * share)],
  8,
  HEAD,
  () => 'head',
);
/** where the camera looks out of it, and how large it is */
export const LENS: readonly Vector[] = Array.from({ length: 12 }, (_, index): Vector => {
  const angle = (2 * Math.PI * index) / 12;
  return [HEAD[0] + HEAD_RADIUS, HEAD[1] + 0.009 * Math.cos(angle), HEAD[2] + 0.009 * Math.sin(angle)];
});
/** m forward and to the right: planes with the hull on one side and the head, or a side's fins, on the other */
export const NECK = HEAD[0] - HEAD_RADIUS / 2;
export const FLANK = 0.055;

const DOWN: Vector = [0, 0, 1];
const SLANT = Math.PI / 6;
/** where a fin turns, and along what it lies at an angle of 0; in the order of the packets */
export const MOUNTS = [
  { forward: 1, right: 1 },
  { forward: -1, right: 1 },
  { forward: -1, right: -1 },
  { forward: 1, right: -1 },
].map(({ forward, right }) => ({
  right,
  pivot: [0.11 * forward, 0.065 * right, 0] as Vector,
  mount: [-Math.cos(SLANT) * forward, Math.sin(SLANT) * right, 0] as Vector,
}));

/** m along the fin from its pivot, and half its chord there: 11 cm long, 4.5 cm wide, 8.8 cm from pivot to tip */
const OUTLINE: readonly (readonly [number, number])[] = [
  [-0.022, 0.006],
  [-0.008, 0.013],
  [0.015, 0.02],
  [0.04, 0.0225],
  [0.064, 0.02],
  [0.08, 0.013],
  [0.088, 0],
];
const EDGE = [...OUTLINE, ...[...OUTLINE].reverse().slice(1).map(([far, half]) => [far, -half] as const)];

const NO_MOUNT = { pivot: [0, 0, 0] as Vector, mount: [1, 0, 0] as Vector };

export interface Fin {
  readonly corners: readonly Vector[];
  readonly normal: Vector;
}

/** A fin at this angle (rad), which grows as its tip goes down. */
export function finAt(index: number, angle: number): Fin {
  const { pivot, mount } = MOUNTS[index] ?? NO_MOUNT;
  const tip = along([mount[0] * Math.cos(angle), mount[1] * Math.cos(angle), 0], DOWN, Math.sin(angle));
  const chord = cross(mount, DOWN);
  return {
    corners: EDGE.map(([far, half]) => along(along(pivot, tip, far), chord, half)),
    normal: cross(tip, chord),
  };
}
