/** What the server names, in words for people. */
import { MISSING } from '../../format';

export const FRAMINGS: Readonly<Record<string, string>> = {
  plain: 'plain numbers',
  thesis: "thesis's packet",
  robot: "robot's own link",
};

export const DIRECTIONS: Readonly<Record<string, string>> = {
  to_board: 'Pi to Arduino',
  to_host: 'Arduino to Pi',
  both: 'both ways at once',
};

export const PLACES: Readonly<Record<string, string>> = {
  emulated: 'emulated time',
  robot: "robot's board",
};

/** What a run is, beside its name. */
export function aboutRun(run: { readonly framing: string; readonly direction: string }): string {
  return `${FRAMINGS[run.framing] ?? run.framing}, ${DIRECTIONS[run.direction] ?? run.direction}`;
}

/** A time that nobody needs to the second: about 40 s, about 3 min, about 1 h 10 min. */
export function roughly(seconds: number): string {
  if (seconds < 55) return `about ${Math.max(5, Math.ceil(seconds / 5) * 5)} s`;
  const minutes = Math.max(1, Math.round(seconds / 60));
  if (minutes < 60) return `about ${minutes} min`;
  const rest = minutes % 60;
  return `about ${Math.floor(minutes / 60)} h${rest === 0 ? '' : ` ${rest} min`}`;
}

/** What is left of a test, of which `remaining` s were left `ago` s ago. */
export function remainingWords(remaining: number | null, ago: number): string {
  if (remaining === null) return 'not known yet';
  const left = remaining - ago;
  return left < 1 ? 'a moment' : roughly(left);
}

/** A rate as the thesis prints it. */
export function rateText(rate: number | null | undefined): string {
  return rate === null || rate === undefined ? MISSING : rate.toFixed(2);
}

/** A difference of rates, always with its sign. */
export function differenceText(difference: number | null): string {
  if (difference === null) return MISSING;
  const digits = Math.abs(difference).toFixed(2);
  if (Number(digits) === 0) return `\u00b1${digits}`;
  return `${difference < 0 ? '\u2212' : '+'}${digits}`;
}

/** How often each cause occurs among the cells, the most frequent first. */
export function countCauses(cells: readonly { readonly causes: readonly string[] }[]): [string, number][] {
  const counts = new Map<string, number>();
  for (const cause of cells.flatMap(({ causes }) => causes)) counts.set(cause, (counts.get(cause) ?? 0) + 1);
  return [...counts].sort(([, one], [, other]) => other - one);
}

/** An explanation, finding by finding; each begins with its cause. */
export function reasonsOf({ explanation, causes }: { readonly explanation: string; readonly causes: readonly string[] }): string[] {
  const reasons: string[] = [];
  for (const part of explanation.split('; ')) {
    const begins = reasons.length === 0 || causes.some((cause) => part.startsWith(`${cause}: `));
    if (begins) reasons.push(part);
    else reasons.push(`${reasons.pop() ?? ''}; ${part}`);
  }
  return reasons;
}
