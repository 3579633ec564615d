/** What visitors are shown, and told. */
import { loopOf } from '../drive/holds';
import type { Mission, State } from '../generated/topics';
import { isGoing, phaseOf } from '../parts/mission/steps';
import { exhibit } from '../texts/exhibit';

const texts = exhibit.now;
export type Shown = 'camera' | 'turtle' | 'curve';
const ORDER: readonly Shown[] = ['turtle', 'camera', 'curve'];
/** m/s from which it dives or rises */
const MOVING = 0.03;

/** The view after this one, of those that there are. */
export function following(shown: Shown, there: Readonly<Record<Shown, boolean>>): Shown {
  const from = ORDER.indexOf(shown);
  return [...ORDER.slice(from + 1), ...ORDER.slice(0, from)].find((view) => there[view]) ?? shown;
}

/** What the turtle does now, in a few words; `speed` in m/s, downwards. */
export function doing(state: State | null, mission: Mission | null, speed: number): string {
  if (state === null) return texts.unknown;
  if (state.mode === 'failsafe') return texts.failsafe;
  if (state.mode === 'disarmed') return texts.disarmed;
  if (state.mode === 'test') return texts.checking;
  if (mission !== null && isGoing(phaseOf(mission, state))) return texts.mission;
  if (Math.abs(speed) >= MOVING) return speed > 0 ? texts.dive : texts.rise;
  if (state.mode === 'manual') return texts.manual;
  const depth = loopOf(state, 'depth');
  return depth?.on ? texts.automatic(depth.set_point.toFixed(1)) : texts.alone;
}
