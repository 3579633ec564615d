import { describe, expect, it } from 'vitest';
import type { Session } from '../src/api';
import type { Mission, MissionStepState, State } from '../src/generated/topics';
import { ENDED_SHOWN, isCurrent, isTimed, listed, nest, phaseInRecording, phaseOf, sessionOf, sinceReport } from '../src/parts/mission/steps';

const step = (path: string, more: Partial<MissionStepState> = {}): MissionStepState => ({
  path,
  do: path === '' ? 'sequence' : 'hold',
  words: 'Hold',
  note: '',
  status: 'waiting',
  elapsed: 0,
  longest: 10,
  rounds: 0,
  text: '',
  ...more,
});
const mission = (phase: Mission['phase'], time = 100): Mission => ({
  time,
  number: 1,
  sequence: 0,
  name: 'test',
  title: 'Test',
  phase,
  text: '',
  elapsed: 5,
  remaining: 5,
  progress: 0.5,
  paused: 0,
  pause: 60,
  deepest: 0.6,
  steps: [],
  document: '',
  surfaced: null,
});
const state = (armed: boolean, time: number) => ({ armed, time }) as State;

describe('the tree of steps', () => {
  it('nests by path, ten and more', () => {
    const paths = ['', '1', '2', '2.1', '2.1.1', ...Array.from({ length: 9 }, (_, place) => String(place + 3))];
    const root = nest(paths.map((path) => step(path)));
    expect(root?.steps.map((one) => one.step.path)).toEqual(['1', '2', '3', '4', '5', '6', '7', '8', '9', '10', '11']);
    expect(root?.steps[1]?.steps[0]?.steps[0]?.step.path).toBe('2.1.1');
    expect(nest([])).toBeNull();
  });

  it('leaves out a sequence that holds everything', () => {
    expect(listed(nest([step(''), step('1')])).map((one) => one.step.path)).toEqual(['1']);
    expect(listed(nest([step('', { do: 'repeat' }), step('1')])).map((one) => one.step.path)).toEqual(['']);
    expect(listed(null)).toEqual([]);
  });

  it('tells the time of steps that take some', () => {
    expect(isTimed(step('1', { longest: 0.1, status: 'done' }))).toBe(false);
    expect(isTimed(step('1'))).toBe(false);
    expect(isTimed(step('1', { status: 'running' }))).toBe(true);
  });
});

describe('a mission on the page', () => {
  it('is lost where the robot was disarmed without its end', () => {
    expect(phaseOf(mission('running'), null)).toBe('running');
    expect(phaseOf(mission('running'), state(false, 100.5))).toBe('running');
    expect(phaseOf(mission('running'), state(false, 102))).toBe('lost');
    expect(phaseOf(mission('paused'), state(true, 102))).toBe('paused');
    expect(phaseOf(mission('failed'), state(false, 200))).toBe('failed');
    expect(phaseInRecording(mission('running'), false)).toBe('lost');
    expect(phaseInRecording(mission('running'), true)).toBe('running');
    expect(phaseInRecording(mission('ended'), false)).toBe('ended');
  });

  it('is shown while it runs, and for a while after its end', () => {
    expect(isCurrent(mission('running'), state(true, 500), 500, null)).toBe(true);
    expect(isCurrent(mission('failed'), state(false, 110), 110, null)).toBe(true);
    expect(isCurrent(mission('failed'), state(true, 110), 110, null)).toBe(false);
    expect(isCurrent(mission('failed'), state(false, 300), 100 + ENDED_SHOWN, null)).toBe(false);
    expect(isCurrent(mission('running'), state(false, 300), 300, null)).toBe(false);
    // Before the first state, and with a clock that is not known yet.
    expect(isCurrent(mission('failed'), null, NaN, null)).toBe(false);
  });

  it('is shown to a page that comes back after the dive', () => {
    const dive = { ...mission('succeeded'), surfaced: 98 };
    expect(isCurrent(dive, state(false, 900), 900, 895)).toBe(true);
    expect(isCurrent(dive, state(false, 900), 895 + ENDED_SHOWN, 895)).toBe(false);
    expect(isCurrent(dive, state(true, 900), 900, 895)).toBe(false);
    expect(isCurrent(dive, state(false, 9000), 9000, 8995)).toBe(false);
    expect(isCurrent(mission('succeeded'), state(false, 900), 900, 895)).toBe(false);
  });

  it('finds the session of a dive', () => {
    const at = (id: number, started: string) => ({ id, started }) as Session;
    const sessions = [at(3, '2026-05-01T10:30:00Z'), at(2, '2026-05-01T10:00:00Z'), at(1, '2026-05-01T09:00:00Z')];
    expect(sessionOf(sessions, new Date('2026-05-01T10:02:00Z'))?.id).toBe(2);
    expect(sessionOf(sessions, new Date('2026-05-01T08:00:00Z'))).toBeNull();
    expect(sessionOf(sessions, new Date(NaN))).toBeNull();
  });

  it('goes on between two reports, and no further', () => {
    expect(sinceReport(mission('running'), 100.4)).toBeCloseTo(0.4);
    expect(sinceReport(mission('running'), 130)).toBe(1);
    expect(sinceReport(mission('running'), 99)).toBe(0);
    expect(sinceReport(mission('running'), NaN)).toBe(0);
  });
});
