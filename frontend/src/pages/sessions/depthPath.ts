/** A small curve of depths in a drawing of 100 by 40, the surface on top. */

const WIDTH = 100;
const TOP = 2;
const BOTTOM = 38;
/** m that the drawing spans at least: a robot that floats draws a flat line */
const DEPTH_LEAST = 0.3;

/** The line, and the area above it, as paths of SVG; null where no depth is known. */
export function depthPath(curve: readonly (number | null)[]): { line: string; area: string } | null {
  const known = curve.flatMap((depth, place) => (depth === null ? [] : [{ x: (place / Math.max(curve.length - 1, 1)) * WIDTH, depth }]));
  const [first, last] = [known[0], known.at(-1)];
  if (first === undefined || last === undefined) return null;
  const deepest = Math.max(DEPTH_LEAST, ...known.map(({ depth }) => depth));
  const y = (depth: number) => TOP + (Math.max(depth, 0) / deepest) * (BOTTOM - TOP);
  const line = known.map(({ x, depth }, place) => `${place === 0 ? 'M' : 'L'}${x.toFixed(1)} ${y(depth).toFixed(1)}`).join('');
  return { line, area: `${line}L${last.x.toFixed(1)} ${TOP}L${first.x.toFixed(1)} ${TOP}Z` };
}
