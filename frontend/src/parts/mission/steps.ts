/** The steps of a mission as a tree, and what of a mission is to be shown. */
import type { Session } from '../../api';
import type { Mission, MissionStepState, State } from '../../generated/topics';

export interface StepNode {
  readonly step: MissionStepState;
  readonly steps: readonly StepNode[];
}

/** s for which a mission is shown after its end */
export const ENDED_SHOWN = 120;
/** s after which a page that comes back does not show it any more */
const PAST = 3600;
/** s from one document of a running mission to the next */
const PERIOD = 1;
/** s, mission's clock; shorter steps show no time */
const SHORT = 1;

export type ShownPhase = Mission['phase'] | 'lost';

/** The tree of steps that come in the order of their document. */
export function nest(steps: readonly MissionStepState[]): StepNode | null {
  const nodes = new Map<string, { step: MissionStepState; steps: StepNode[] }>();
  for (const step of steps) {
    const node = { step, steps: [] };
    nodes.set(step.path, node);
    if (step.path !== '') nodes.get(parentOf(step.path))?.steps.push(node);
  }
  return nodes.get('') ?? null;
}

function parentOf(path: string): string {
  return path.includes('.') ? path.slice(0, path.lastIndexOf('.')) : '';
}

/** The steps to list: a sequence that holds everything says nothing. */
export function listed(root: StepNode | null): readonly StepNode[] {
  if (root === null) return [];
  return root.step.do === 'sequence' && root.steps.length > 0 ? root.steps : [root];
}

/** The phase; a mission of a robot that has been disarmed since is lost: the runtime was started anew, for one. */
export function phaseOf(mission: Mission, state: State | null): ShownPhase {
  const disarmed = state !== null && !state.armed && state.time > mission.time + PERIOD;
  return isGoing(mission.phase) && disarmed ? 'lost' : mission.phase;
}

/** The phase in a recording, which may lack a mission's end. */
export function phaseInRecording(mission: Mission, recording: boolean): ShownPhase {
  return isGoing(mission.phase) && !recording ? 'lost' : mission.phase;
}

export function isGoing(phase: ShownPhase): boolean {
  return phase === 'running' || phase === 'paused';
}

/**
 * True where Operate shows a mission by itself: while it runs, and for a while after its end. A dive that surfaced
 * while nobody was connected is shown from `back` on, when this page came back (s, steady clock).
 */
export function isCurrent(mission: Mission, state: State | null, now: number, back: number | null): boolean {
  if (isGoing(phaseOf(mission, state))) return true;
  const missed = mission.surfaced !== null && back !== null && back - mission.time < PAST;
  return state?.armed !== true && now - Math.max(mission.time, missed ? back : -Infinity) < ENDED_SHOWN;
}

/** The session of a dive that was at the surface then: the newest that had begun; they come newest first. */
export function sessionOf(sessions: readonly Session[], surfaced: Date): Session | null {
  return sessions.find(({ started }) => Date.parse(started) < surfaced.getTime()) ?? null;
}

/** s since the newest document, for what goes on between two of them. */
export function sinceReport(mission: Mission, now: number): number {
  const since = now - mission.time;
  return Number.isFinite(since) ? Math.min(Math.max(since, 0), PERIOD) : 0;
}

/** True where a step lasts so long that its time means something. */
export function isTimed(step: MissionStepState): boolean {
  return step.longest > SHORT && step.status !== 'waiting';
}
