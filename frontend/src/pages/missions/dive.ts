/** The checks before a dive: what the robot knows, judged. What only a person sees is in the texts. */
import type { MissionSummary } from '../../api';
import { bytes, duration, fixed } from '../../format';
import { SENSED } from '../../live/battery';
import type { Verdict } from '../../parts/sign';
import { missions } from '../../texts/missions';

const texts = missions.dive;
/** V below which a pack of two cells is less than half full */
const BATTERY_HALF = 7.4;
/** m from the surface that a depth at rest may show */
const AT_SURFACE = 0.05;
/** bytes that an hour of recording does not fill */
const SPACE = 1e9;
/** s by which the robot's clock may differ from this device's */
const CLOCK = 60;

/** What is known of the robot; null where it is not. */
export interface DiveFacts {
  /** V */
  readonly battery: number | null;
  /** s that it lasts; null where its capacity is not known */
  readonly left: number | null;
  /** V at which the board disarms */
  readonly alarm: number;
  /** steps that the board's calibration lacks */
  readonly missing: readonly string[] | null;
  /** m */
  readonly depth: number | null;
  /** bytes that are free where sessions are stored */
  readonly free: number | null;
  /** s by which the robot's clock is ahead of this device's */
  readonly ahead: number | null;
  readonly wet: boolean | null;
  /** whether it is known by how much the robot floats */
  readonly weighed: boolean | null;
  readonly mission: Pick<MissionSummary, 'longest' | 'unwatched'> | null;
}

export interface DiveCheck {
  readonly name: string;
  readonly verdict: Verdict;
  readonly text: string;
}

/** The checks with their figures; the battery's is a person's where nothing measures it. */
export function judgeDive(facts: DiveFacts): DiveCheck[] {
  const { battery, left, alarm, missing, depth, free, ahead, wet, weighed, mission } = facts;
  const checks: DiveCheck[] = [];
  const add = (name: string, known: boolean, good: boolean, text: () => string) =>
    checks.push({ name, verdict: !known ? 'unknown' : good ? 'good' : 'look', text: known ? text() : texts.unknown });
  if (measuresBattery(battery)) {
    if (left !== null && mission !== null) {
      const [lasts, planned] = [Math.floor(left / 60), Math.ceil(mission.longest / 60)];
      add(texts.battery, true, left >= mission.longest, () => (left >= mission.longest ? texts.lasts : texts.tooShort)(lasts, planned));
    } else {
      const full = battery >= BATTERY_HALF;
      add(texts.battery, true, full, () => (full ? texts.volts : texts.voltsLow)(fixed(battery, 1), fixed(alarm, 1)));
    }
  }
  add(texts.leak, wet !== null, !wet, () => (wet ? texts.wet : texts.dry));
  add(texts.buoyancy, weighed !== null, weighed === true, () => (weighed ? texts.weighed : texts.unweighed));
  add(texts.calibration, missing !== null, missing?.length === 0, () => (missing?.length ? texts.missing(missing.length) : texts.calibrated));
  add(texts.depth, depth !== null, Math.abs(depth ?? 0) <= AT_SURFACE, () =>
    (Math.abs(depth ?? 0) <= AT_SURFACE ? texts.atSurface : texts.offSurface)(fixed(depth, 2)),
  );
  add(texts.space, free !== null, (free ?? 0) >= SPACE, () => texts.free(bytes(free ?? 0)));
  add(texts.clock, ahead !== null, Math.abs(ahead ?? 0) <= CLOCK, () =>
    Math.abs(ahead ?? 0) <= CLOCK ? texts.clockRight : texts.clockOff(duration(Math.abs(ahead ?? 0))),
  );
  const { longest = 0, unwatched = 0 } = mission ?? {};
  add(texts.page, mission !== null, unwatched === 0 || unwatched >= longest, () =>
    unwatched === 0 || unwatched >= longest ? texts.pageless(duration(longest)) : texts.watched(duration(unwatched)),
  );
  return checks;
}

export function measuresBattery(volts: number | null): volts is number {
  return volts !== null && volts >= SENSED;
}
