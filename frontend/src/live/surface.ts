/** Whether a depth may be measured from the wrong place: the surface’s pressure changed, or was measured under water. */

/** m above the surface that are neither noise nor a wave; the board too counts 5 cm as the surface */
const ABOVE = 0.05;
/** m above it at which that is over, so that noise at the limit changes nothing */
const AT_IT = 0.03;
/** Pa, of the air from lakes at 2,000 m to the highest at sea, as the bring-up takes it */
const AIR_MIN = 80_000;
const AIR_MAX = 110_000;
/** m/s² */
const GRAVITY = 9.81;

export type SurfaceDoubt =
  /** the board lost what it had measured, and shows the depth below the surface before */
  | { readonly kind: 'lost' }
  /** what it took for the surface's pressure, Pa, is not air's */
  | { readonly kind: 'air'; readonly pressure: number }
  /** m above the surface */
  | { readonly kind: 'above'; readonly height: number };

export interface Measured {
  /** m */
  readonly depth: number;
  /** Pa */
  readonly pressure: number;
  /** kg/m³ of the water */
  readonly density: number;
  /** whether the board itself says that its depth is uncertain */
  readonly lost: boolean;
}

/** @param before what was in doubt at the last reading */
export function findSurfaceDoubt(measured: Measured, before: SurfaceDoubt | null): SurfaceDoubt | null {
  const { depth, pressure, density, lost } = measured;
  if (lost) return { kind: 'lost' };
  const surface = pressure - depth * density * GRAVITY;
  if (surface < AIR_MIN || surface > AIR_MAX) return { kind: 'air', pressure: surface };
  return depth < -(before?.kind === 'above' ? AT_IT : ABOVE) ? { kind: 'above', height: -depth } : null;
}
