/** s that the curve shows */
const SECONDS = 60;
/** m: a robot at rest is a straight line, and no noise */
const SHALLOWEST = 0.5;
/** in the drawing's units: the surface's line, and half of the curve's */
const EDGE = 2;

/** The path of a curve of depths, downwards from the surface, the newest at the right edge; it breaks where one is not known. */
export function curve(depths: readonly (number | null)[], width: number, height: number): string {
  const deepest = Math.max(SHALLOWEST, ...depths.map((depth) => depth ?? 0));
  const step = width / (SECONDS - 1);
  const first = width - step * (depths.length - 1);
  let path = '';
  let pen = 'M';
  depths.forEach((depth, index) => {
    if (depth === null) {
      pen = 'M';
      return;
    }
    const y = EDGE + (Math.max(0, depth) / deepest) * (height - 2 * EDGE);
    path += `${pen}${(first + index * step).toFixed(1)} ${y.toFixed(1)}`;
    pen = 'L';
  });
  return path;
}
