/** A number with four significant digits, as short as it can be. */
export function significant(value: number): string {
  const short = Number(value.toPrecision(4));
  return (Math.abs(short) >= 1e-3 || short === 0 ? String(short) : short.toExponential()).replaceAll('-', '\u2212');
}
