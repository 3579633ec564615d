/** Outlines of the turtle that several pictures draw, in units of the pictures. */

/** from above, its nose up */
export const SHELL = 'M0 -72C26 -72 40 -44 40 0S26 72 0 72S-40 44 -40 0S-26 -72 0 -72z';
export const SCUTES = 'M0 -62V62M-32 -32H32M-40 0H40M-32 32H32';
export const HEAD = 'M14 -84A14 14 0 1 1 -14 -84A14 14 0 1 1 14 -84z';
/** of a fin from its root to its tip, along x */
export const FIN = 'M-5 0C6 -13 36 -12 52 0C36 12 6 13 -5 0z';
/** by fin: where its root is, and where it points along its mount (°) */
export const ROOTS = [
  { x: 33, y: -46, aim: 60 },
  { x: 33, y: 46, aim: -60 },
  { x: -33, y: 46, aim: -120 },
  { x: -33, y: -46, aim: 120 },
] as const;

/** from its right side, its nose to the right, on y = 0 */
export const HULL = 'M-70 -14C-62 -40 -20 -48 10 -44C40 -40 56 -26 60 -16C40 -2 -50 2 -70 -14z';
export const SNOUT = 'M54 -22C58 -36 78 -36 82 -22C82 -12 62 -8 54 -14z';
/** from behind, on y = 0 */
export const SECTION = 'M-46 -12C-42 -46 42 -46 46 -12C34 2 -34 2 -46 -12z';
