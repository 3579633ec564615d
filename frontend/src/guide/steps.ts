/** The ten steps of a first dive: where each is done, which control does it, and by what one sees that it is done. */
import type { ExportJob, Session } from '../api';
import type { Detection, Mission, State } from '../generated/topics';
import { loopOf } from '../drive/holds';
import { isGoing, phaseOf } from '../parts/mission/steps';
import type { PageName } from '../router.svelte';

/** What robot, recordings and page show now. */
export interface Situation {
  readonly page: PageName;
  /** what the address names within the page */
  readonly within: readonly string[];
  readonly state: State | null;
  /** m; null while unknown */
  readonly depth: number | null;
  readonly detection: Detection | null;
  readonly mission: Mission | null;
  readonly recording: Session | null;
  /** whether the bystander's picture is shown */
  readonly outside: boolean;
  /** whether this computer can draw that picture */
  readonly drawable: boolean;
  /** those that ended since it has been the step to create one */
  readonly exports: readonly ExportJob[];
}

interface Place {
  /** null where it can be done on every page */
  readonly page: PageName | null;
  /** selectors of what is pressed for it: the first that is there is next */
  readonly controls: readonly string[];
}

interface Step extends Place {
  /** whether it needs an armed robot */
  readonly armed?: true;
  readonly done: (now: Situation) => boolean;
}

export const STEP_NAMES = ['look', 'dive', 'card', 'controller', 'mark', 'stop', 'mission', 'story', 'compare', 'export'] as const;
export type StepName = (typeof STEP_NAMES)[number];
/** What is to be done now: a step, or what it needs first. */
export type Task = StepName | 'acknowledge';

/** m from which on it has dived */
const DIVED = 0.3;
const MODEL_BASED = 'predictive';
/** one that is still being recorded is the last choice */
const ENDED = '.session:not(:has(.recording))';
const TICK = '.tick:has(input:not(:checked))';
const SESSION = [`${ENDED} .name a`, '.session .name a'];

const inSession = ({ page, within }: Situation) => page === 'sessions' && Number(within[0]) > 0;

export const STEPS: Readonly<Record<StepName, Step>> = {
  look: {
    page: 'operate',
    controls: ['.whose > .segmented > :last-child'],
    done: ({ outside, drawable }) => outside || !drawable,
  },
  dive: {
    page: 'operate',
    controls: ['.hold'],
    done: ({ state, depth }) => state?.armed === true && depth !== null && depth > DIVED,
  },
  card: {
    page: 'operate',
    controls: ['.cards .button:has(.yellow)', '.whose > .segmented > :first-child'],
    armed: true,
    done: ({ state, detection }) => typeof detection?.target === 'string' && detection.target === state?.card,
  },
  controller: {
    page: 'operate',
    controls: ['.apply .primary', 'fieldset:has(.apply) > select', '[role="tab"][id$="-tuning"]'],
    armed: true,
    done: ({ state }) => loopOf(state, 'depth')?.controller === MODEL_BASED,
  },
  mark: {
    page: null,
    controls: ['.opener:has(.lamp)'],
    armed: true,
    done: ({ recording }) => recording !== null && recording.markers > 0,
  },
  // The next arming would go on in a recording that is still open.
  stop: {
    page: null,
    controls: ['.stop'],
    done: ({ state, recording }) => state !== null && !state.armed && recording?.origin !== 'arming',
  },
  mission: {
    page: 'missions',
    controls: ['.hold', 'a[href="#/missions/edit/two_depths"]', '.back'],
    done: ({ mission, state }) => mission !== null && isGoing(phaseOf(mission, state)),
  },
  story: {
    page: 'sessions',
    controls: [...SESSION, '.back'],
    done: (now) => inSession(now) && now.within[1] === undefined,
  },
  compare: {
    page: 'sessions',
    controls: ['.chosen a.primary', `${ENDED} ${TICK}`, TICK, '.back'],
    done: ({ page, within }) => page === 'sessions' && within[0] === 'compare' && (within[1] ?? '').includes(','),
  },
  export: {
    page: 'sessions',
    controls: ['.last > button.primary', '.tab[href$="/data"]', ...SESSION, '.back'],
    done: (now) => now.exports.some(({ state }) => state === 'done'),
  },
};

/** After a failsafe nothing arms before somebody has acknowledged it. */
const ACKNOWLEDGE: Place = { page: 'operate', controls: ['.failsafe ~ .button'] };
const placeOf = (task: Task): Place => (task === 'acknowledge' ? ACKNOWLEDGE : STEPS[task]);
export const pageOf = (task: Task): PageName | null => placeOf(task).page;

/** How many steps are done as things stand, of which so many were done before: the next one counts, and no later one. */
export function doneNow(before: number, now: Situation): number {
  const name = STEP_NAMES[before];
  return name !== undefined && STEPS[name].done(now) ? before + 1 : before;
}

/** What is to be done for this step: who was disarmed meanwhile dives first, and who was stopped by a failsafe acknowledges it. */
export function neededFor(name: StepName, { state }: Situation): Task {
  const step = STEPS[name].armed === true && state?.armed === false ? 'dive' : name;
  return state?.mode === 'failsafe' && (step === 'dive' || step === 'mission') ? 'acknowledge' : step;
}

/** The control to press on this page, where it is there: of the task itself, or the tab of the page that has it. */
export function controlOf(task: Task, page: PageName, within: ParentNode): HTMLElement | null {
  const place = placeOf(task);
  const here = place.page === null || place.page === page;
  for (const selector of here ? place.controls : [`.tab[href="#/${place.page}"]`]) {
    const found = within.querySelector<HTMLElement>(selector);
    if (found !== null) return found;
  }
  return null;
}
