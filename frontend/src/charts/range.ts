const STEPS = [0.5, 1, 1.5, 2, 3, 4, 5, 7.5, 10];

/** A round depth (m) that shows all of `deepest` with some room below it. */
export function depthRange(deepest: number): number {
  const wanted = deepest * 1.08;
  return STEPS.find((step) => step >= wanted) ?? Math.ceil(wanted / 5) * 5;
}

/** The greatest of the points, at least `least`. */
export function greatest(points: readonly (number | null | undefined)[], least: number): number {
  let most = least;
  for (const point of points) {
    if (typeof point === 'number' && point > most) most = point;
  }
  return most;
}
