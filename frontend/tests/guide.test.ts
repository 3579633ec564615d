import { readFileSync } from 'node:fs';
import { afterEach, describe, expect, it, vi } from 'vitest';
import type { ExportJob, Session } from '../src/api';
import type { Detection, Mission, State } from '../src/generated/topics';
import { Guide } from '../src/guide/guide.svelte';
import { doneNow, neededFor, STEP_NAMES, STEPS, type Situation, type StepName } from '../src/guide/steps';
import { guide as texts } from '../src/texts/guide';

const SURFACE: Situation = {
  page: 'operate',
  within: [],
  state: { time: 10, armed: false, card: null, loops: [{ name: 'depth', controller: 'bang_bang' }] } as unknown as State,
  depth: 0,
  detection: null,
  mission: null,
  recording: null,
  outside: false,
  drawable: true,
  exports: [],
};
const inState = (changes: Partial<State>, more: Partial<Situation> = {}): Situation => ({ ...SURFACE, ...more, state: { ...SURFACE.state, ...changes } as State });
const recording = (markers: number, origin: Session['origin'] = 'arming') => ({ markers, origin }) as Session;
const yellow = { target: 'yellow' } as Detection;
const mission = (phase: Mission['phase']) => ({ name: 'two_depths', time: 10, phase }) as Mission;

/** For each step what is not enough, and what does it. */
const CASES: Record<StepName, readonly [not: Situation, done: Situation]> = {
  look: [SURFACE, { ...SURFACE, outside: true }],
  dive: [inState({ armed: true }, { depth: 0.1 }), inState({ armed: true }, { depth: 0.4 })],
  card: [inState({}, { detection: yellow }), inState({ card: 'yellow' }, { detection: yellow })],
  controller: [SURFACE, inState({ loops: [{ name: 'depth', controller: 'predictive' }] as State['loops'] })],
  mark: [{ ...SURFACE, recording: recording(0) }, { ...SURFACE, recording: recording(1) }],
  stop: [{ ...SURFACE, recording: recording(1) }, { ...SURFACE, recording: recording(1, 'operator') }],
  mission: [{ ...SURFACE, mission: mission('succeeded') }, inState({ armed: true }, { mission: mission('running') })],
  story: [{ ...SURFACE, page: 'sessions', within: ['3', 'data'] }, { ...SURFACE, page: 'sessions', within: ['3'] }],
  compare: [{ ...SURFACE, page: 'sessions', within: ['compare', '3'] }, { ...SURFACE, page: 'sessions', within: ['compare', '3,4'] }],
  export: [{ ...SURFACE, exports: [{ state: 'running' } as ExportJob] }, { ...SURFACE, exports: [{ state: 'done' } as ExportJob] }],
};

describe('a step of the first dive', () => {
  it.each(STEP_NAMES)('%s is done by what the robot and the page show', (name) => {
    const [not, done] = CASES[name];
    expect([not, done].map(STEPS[name].done)).toEqual([false, true]);
    // Whoever has ticked off an earlier one has not yet done it.
    const place = STEP_NAMES.indexOf(name);
    expect([doneNow(place, not), doneNow(place, done)]).toEqual([place, place + 1]);
  });

  it('is not waited for where this computer cannot draw what it shows', () => {
    expect(STEPS.look.done({ ...SURFACE, drawable: false })).toBe(true);
  });

  it('begins with arming where the robot was disarmed meanwhile', () => {
    expect(neededFor('card', SURFACE)).toBe('dive');
    expect(neededFor('card', inState({ armed: true }))).toBe('card');
    expect(neededFor('story', SURFACE)).toBe('story');
  });

  it('begins with acknowledging where a failsafe bars arming', () => {
    const failsafe = inState({ mode: 'failsafe' });
    const needed = STEP_NAMES.filter((name) => neededFor(name, failsafe) === 'acknowledge');
    expect(needed).toEqual(['dive', 'card', 'controller', 'mark', 'mission']);
  });

  it('stands in the tutorial under the same title, in the same order, and names the same controls', () => {
    const tutorial = readFileSync(new URL('../../docs/use/tutorial.md', import.meta.url), 'utf8');
    const [, ...chapters] = tutorial.split(/^## \d+\. /m);
    const named = (text: string) => [...text.matchAll(/\*\*(.+?)\*\*/g)].map(([, name]) => name);
    expect(chapters.map((chapter) => chapter.split('\n')[0])).toEqual(STEP_NAMES.map((name) => texts.steps[name].title));
    expect(chapters.map((chapter) => named(chapter.split(/^## /m)[0] ?? ''))).toEqual(STEP_NAMES.map((name) => named(texts.steps[name].text)));
  });
});

describe('the guide', () => {
  afterEach(() => {
    vi.unstubAllGlobals();
  });

  function stored(before?: string): Map<string, string> {
    const values = new Map(before === undefined ? [] : [['mucat-guide', before]]);
    vi.stubGlobal('localStorage', { getItem: (key: string) => values.get(key) ?? null, setItem: (key: string, value: string) => values.set(key, value) });
    return values;
  }

  it('goes on where this browser has left it, and goes for good by one press', () => {
    stored();
    const first = new Guide();
    expect([first.shown, first.done]).toEqual([true, 0]);
    first.reach(3);
    expect([new Guide().shown, new Guide().done]).toEqual([true, 3]);
    first.end();
    expect(new Guide().shown).toBe(false);
    first.open();
    expect([new Guide().shown, new Guide().done]).toEqual([true, 3]);
  });

  it('begins anew after its end', () => {
    stored();
    const guide = new Guide();
    guide.reach(STEP_NAMES.length);
    guide.finish();
    expect(new Guide().shown).toBe(false);
    guide.open();
    expect(new Guide().done).toBe(0);
  });

  it.each(['nonsense', '7', '{"done":-2,"shown":"no","folded":1}'])('takes no harm from %s in the storage', (before) => {
    stored(before);
    const guide = new Guide();
    expect([guide.done, guide.shown, guide.folded]).toEqual([0, true, null]);
  });
});
