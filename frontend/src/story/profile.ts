/** The depth profile as shapes: scales, pieces of the line by who swam, and flags gathered where they are dense. */
import type { Flag, Segment, SignalLine } from '../api';

/** From `start` to `end`, s since the session's start. */
export interface TimeSpan {
  readonly start: number;
  readonly end: number;
}

/** Where times and depths lie, px. */
export interface Scale {
  readonly view: TimeSpan;
  /** of the drawn area */
  readonly width: number;
  readonly height: number;
  /** m at its lower edge */
  readonly lowest: number;
}

/** Who swam: a controller, a mode without one, or nobody. */
export interface Swimmer {
  readonly key: string;
  readonly title: string;
  /** token of its colour */
  readonly colour: string;
}

export interface Piece {
  readonly swimmer: Swimmer;
  readonly path: string;
}

export interface FlagGroup {
  /** px from the left */
  readonly x: number;
  readonly flags: readonly Flag[];
  /** the gravest, and of those the first */
  readonly gravest: Flag;
  /** px until the next group */
  readonly room: number;
}

const CONTROLLERS: Readonly<Record<string, string>> = { bang_bang: 'series-measured', pid: 'series-third', predictive: 'series-4' };
const OTHER = 'series-6';
const MODES: Readonly<Record<string, string>> = { manual: 'series-5', failsafe: 'alarm' };
const GRAVITY = { alarm: 2, caution: 1, info: 0 } as const;
/** m that the profile shows at least */
const LOWEST = 0.3;
/** px between two groups of flags */
const FLAG_ROOM = 26;
const SURFACE_ROOM = 1.1;
const TIME_STEPS = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14_400];
const DEPTH_STEPS = [0.1, 0.2, 0.5, 1, 2, 5, 10];

export const clamp = (value: number, least: number, most: number): number => Math.min(most, Math.max(least, value));
export const across = (scale: Scale, time: number): number => (scale.width * (time - scale.view.start)) / (scale.view.end - scale.view.start);
export const timeAt = (scale: Scale, x: number): number => scale.view.start + ((scale.view.end - scale.view.start) * clamp(x, 0, scale.width)) / Math.max(scale.width, 1);
export const down = (scale: Scale, depth: number): number => (scale.height * clamp(depth, -0.05, scale.lowest)) / scale.lowest;

/** The depth at the lower edge, a little below all that is drawn. */
export function lowestOf(lines: readonly (SignalLine | null)[]): number {
  const values = lines.flatMap((line) => line?.high.filter((value) => value !== null) ?? []);
  return SURFACE_ROOM * values.reduce((most, value) => Math.max(most, value), LOWEST);
}

/** Whole steps from 0 to `most`, at least `room` px apart. */
function steps(choices: readonly number[], start: number, end: number, pixels: number, room: number): number[] {
  const span = end - start;
  const step = choices.find((one) => (one / span) * pixels >= room) ?? choices.at(-1) ?? span;
  const first = Math.ceil(start / step - 1e-9);
  return Array.from({ length: Math.max(0, Math.floor(end / step + 1e-9) - first + 1) }, (_, index) => Number(((first + index) * step).toFixed(6)));
}

export const timeSteps = ({ view, width }: Scale): number[] => steps(TIME_STEPS, view.start, view.end, width, 84);
export const depthSteps = ({ lowest, height }: Scale): number[] => steps(DEPTH_STEPS, 0, lowest, height, 34);

/** Who swam in a segment; null: outside of all, where the robot is disarmed. */
export function swimmerOf(segment: Segment | null, kinds: Readonly<Record<string, string>>): Swimmer {
  if (segment === null) return { key: 'disarmed', title: kinds.disarmed ?? '', colour: 'series-7' };
  const { mode, controller, title } = segment;
  if (controller !== '' && mode !== 'manual') return { key: controller, title, colour: CONTROLLERS[controller] ?? OTHER };
  const name = kinds[mode] ?? kinds.unknown ?? mode;
  return { key: `${mode} ${controller}`, title: controller === '' ? name : `${name}, ${title}`, colour: MODES[mode] ?? OTHER };
}

/** The depth's line in pieces, each of who swam then; a piece begins where the one before ends. */
export function piecesOf(line: SignalLine, segments: readonly Segment[], scale: Scale, kinds: Readonly<Record<string, string>>): Piece[] {
  const pieces: { swimmer: Swimmer; points: string[] }[] = [];
  const nobody = swimmerOf(null, kinds);
  const swimmers = segments.map((segment) => swimmerOf(segment, kinds));
  let place = 0;
  let before = '';
  line.time.forEach((time, index) => {
    const [low, high] = [line.low[index] ?? null, line.high[index] ?? null];
    while (place < segments.length && (segments[place]?.end ?? 0) <= time) place += 1;
    const segment = segments[place];
    const swimmer = (segment !== undefined && segment.start <= time ? swimmers[place] : undefined) ?? nobody;
    if (low === null || high === null) {
      before = '';
      pieces.push({ swimmer, points: [] });
      return;
    }
    const x = across(scale, time).toFixed(1);
    const points = low === high ? [`${x} ${down(scale, low).toFixed(1)}`] : [`${x} ${down(scale, low).toFixed(1)}`, `${x} ${down(scale, high).toFixed(1)}`];
    const last = pieces.at(-1);
    if (last === undefined || (last.points.length > 0 && last.swimmer.key !== swimmer.key)) pieces.push({ swimmer, points: before === '' ? points : [before, ...points] });
    else if (last.points.length === 0) pieces[pieces.length - 1] = { swimmer, points };
    else last.points.push(...points);
    before = points.at(-1) ?? '';
  });
  return pieces.filter(({ points }) => points.length > 0).map(({ swimmer, points }) => ({ swimmer, path: `M${points.join('L')}` }));
}

/** The set point's line: each value holds until the next. */
export function stairs(line: SignalLine, scale: Scale): string {
  let path = '';
  let drawing = false;
  line.time.forEach((time, index) => {
    const value = line.high[index] ?? null;
    if (value === null) {
      drawing = false;
      return;
    }
    const [x, y] = [across(scale, time).toFixed(1), down(scale, value).toFixed(1)];
    path += drawing ? `H${x}V${y}` : `M${x} ${y}`;
    drawing = true;
  });
  return path;
}

/** Those who swam, each once, in the order in which they come. */
export function swimmersOf(pieces: readonly Piece[]): Swimmer[] {
  return [...new Map(pieces.map(({ swimmer }) => [swimmer.key, swimmer])).values()];
}

/** The flags in view, those that would lie over each other together. */
export function gatherFlags(flags: readonly Flag[], scale: Scale): FlagGroup[] {
  const groups: { x: number; flags: Flag[] }[] = [];
  for (const flag of flags) {
    if (flag.time < scale.view.start || flag.time > scale.view.end) continue;
    const x = across(scale, flag.time);
    const last = groups.at(-1);
    if (last !== undefined && x - last.x < FLAG_ROOM) last.flags.push(flag);
    else groups.push({ x, flags: [flag] });
  }
  return groups.map((group, index) => ({
    ...group,
    gravest: group.flags.reduce((gravest, flag) => (GRAVITY[flag.severity] > GRAVITY[gravest.severity] ? flag : gravest)),
    room: (groups[index + 1]?.x ?? scale.width) - group.x,
  }));
}

/** The value of a line at a time: the middle of its column; null where there is none. */
export function valueAt(line: SignalLine | null, time: number): number | null {
  if (line === null || line.time.length === 0) return null;
  let [first, last] = [0, line.time.length - 1];
  while (first < last) {
    const middle = (first + last + 1) >> 1;
    if ((line.time[middle] ?? 0) <= time) first = middle;
    else last = middle - 1;
  }
  const [low, high] = [line.low[first] ?? null, line.high[first] ?? null];
  return low === null || high === null ? null : (low + high) / 2;
}

/** The line where a segment holds the depth, broken elsewhere. */
export function heldOnly(line: SignalLine, segments: readonly Segment[]): SignalLine {
  const isHeld = (time: number) => segments.some((segment) => segment.holds_depth && segment.start <= time && time < segment.end);
  const held = line.time.map(isHeld);
  const masked = (values: readonly (number | null)[]) => values.map((value, index) => (held[index] ? value : null));
  return { time: line.time, low: masked(line.low), high: masked(line.high) };
}

/** The time of the greatest depth; null where there is none. */
export function deepestTime(line: SignalLine): number | null {
  let deepest = -Infinity;
  let time: number | null = null;
  line.high.forEach((value, index) => {
    if (value === null || value <= deepest) return;
    deepest = value;
    time = line.time[index] ?? null;
  });
  return time;
}
