/** Why a number that was typed cannot be read. */
export const numbers = {
  none: 'Enter a number.',
  notNumber: (typed: string) => `“${typed}” is not a number.`,
  otherUnit: (typed: string, unit: string) => `“${typed}” has another unit: enter a number ${unit === '' ? 'without a unit' : `in ${unit}`}.`,
  ambiguous: (typed: string, decimal: string, whole: string) => `“${typed}” can be ${decimal} or ${whole}: enter one of these.`,
  ambiguousEntry: (typed: string, one: string, several: string) => `“${typed}” can be one number, ${one}, or several, ${several}: enter one of these.`,
  ambiguousList: (typed: string) => `“${typed}” can be read in several ways: enter decimal points, and a space after each comma between numbers.`,
  notStorable: (typed: string) => `“${typed}” has too many digits, or is too large or too small.`,
  notWhole: (typed: string) => `“${typed}” is not a whole number.`,
  outOfRange: (value: string, minimum: string, maximum: string, unit: string) => `${value} is outside of ${minimum} to ${maximum}${unit === '' ? '' : ` ${unit}`}.`,
  tooSmall: (value: string, minimum: string, unit: string) => `${value} is below ${minimum}${unit === '' ? '' : ` ${unit}`}.`,
  correctFirst: 'Correct the marked numbers first.',
} as const;
