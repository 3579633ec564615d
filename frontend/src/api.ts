/** The server's HTTP interface. Every call answers `null` or its result, or what went wrong in words. */
import type { components } from './generated/api';

type Schemas = components['schemas'];
export type Part = Schemas['PartHealth'];
export type LinkFrame = Schemas['LinkFrame'];
export type LinkFrames = Schemas['LinkFrames'];
export type Session = Schemas['Session'];
export type CommTestDocument = Schemas['TestDocument'];
export type CommTestCheck = Schemas['Check'];
export type CommTestPlace = Schemas['Start']['place'];
export type CommTestSummary = Schemas['RunSummary'];
export type CommTestRun = Schemas['Run'];
export type Cell = Schemas['Cell'];
export type ScenarioText = Schemas['ScenarioText'];
export type ScenarioSummary = Schemas['ScenarioSummary'];
export type ScenarioEvent = Schemas['ScenarioEvent'];
export type ScenarioCheck = Schemas['ScenarioCheck'];
export type ScenarioState = Schemas['ScenarioState'];
export type ScenarioStart = Schemas['ScenarioStart'];
export type View = Schemas['View'];
export type ThesisTable = Schemas['ThesisTable'];

export type Answer<T> = { readonly value: T } | { readonly problem: string };

const TIMEOUT = 5000;
const TIMEOUT_STOP = 2000;
/** ms; a board may have to be handed over first, or to get its firmware back */
const TIMEOUT_COMM_TEST = 120_000;

async function request<T>(method: string, path: string, body?: object, timeout = TIMEOUT): Promise<Answer<T>> {
  try {
    const response = await fetch(`/api${path}`, {
      method,
      headers: body ? { 'Content-Type': 'application/json' } : {},
      ...(body ? { body: JSON.stringify(body) } : {}),
      signal: AbortSignal.timeout(timeout),
    });
    const text = await response.text();
    if (!response.ok) return { problem: describe(response.status, text) };
    return { value: (text === '' ? null : JSON.parse(text)) as T };
  } catch {
    return { problem: 'The server does not answer. Look whether it runs and whether this device is in its network.' };
  }
}

function describe(status: number, text: string): string {
  try {
    const { detail } = JSON.parse(text) as { detail?: unknown };
    if (typeof detail === 'string') return detail;
    if (Array.isArray(detail)) return detail.map((one: { msg?: string }) => one.msg ?? '').join('; ');
  } catch {
    // Not JSON: something between the page and the server answered in its place.
  }
  return `The server refused with status ${status} and gave no reason. Try again, and look into its log.`;
}

async function command(method: string, path: string, body?: object, timeout?: number): Promise<string | null> {
  const answer = await request<null>(method, path, body, timeout);
  return 'problem' in answer ? answer.problem : null;
}

export const api = {
  stop: () => command('POST', '/robot/stop', undefined, TIMEOUT_STOP),
  arm: () => command('POST', '/robot/arm'),
  controller: (name: string, gains: Record<string, number>) => command('PUT', '/robot/controller', { name, gains }),
  setPoints: (points: Schemas['SetPoints']) => command('PUT', '/robot/set-points', points),
  card: (colour: string | null) => command('PUT', '/robot/card', { colour }),
  vision: (wanted: Schemas['Vision']) => command('PUT', '/robot/vision', wanted),
  view: (view: View) => command('PUT', '/scene/view', view),
  simulator: (here: boolean) => command('PUT', '/simulator', { here }),
  health: () => request<Schemas['Health']>('GET', '/health'),
  linkFrames: () => request<LinkFrames>('GET', '/link/frames'),
  sessions: () => request<Session[]>('GET', '/sessions'),
  startSession: (name: string, note: string) => request<Session>('POST', '/sessions', { name, note }),
  stopSession: (id: Session['id']) => request<Session>('POST', `/sessions/${id}/stop`),
  csv: (id: Session['id']) => `/api/sessions/${id}/csv`,
  commTestDocuments: () => request<CommTestDocument[]>('GET', '/comm-tests/documents'),
  checkCommTest: (text: string) => request<CommTestCheck>('POST', '/comm-tests/check', { text }),
  startCommTest: (text: string, place: CommTestPlace) =>
    request<Schemas['Started']>('POST', '/comm-tests/runs', { text, place }, TIMEOUT_COMM_TEST),
  cancelCommTest: () => command('POST', '/comm-tests/cancel', undefined, TIMEOUT_COMM_TEST),
  commTestRuns: () => request<CommTestSummary[]>('GET', '/comm-tests/runs'),
  commTestRun: (id: CommTestRun['id']) => request<CommTestRun>('GET', `/comm-tests/runs/${id}`),
  commTestFile: (id: CommTestRun['id'], format: 'csv' | 'json') => `/api/comm-tests/runs/${id}/${format}`,
  scenarios: () => request<ScenarioText[]>('GET', '/scenarios'),
  keepScenario: (text: string) => request<ScenarioSummary>('POST', '/scenarios', { text }),
  checkScenario: (text: string) => request<ScenarioCheck>('POST', '/scenarios/check', { text }),
  startScenario: (start: ScenarioStart) => request<Schemas['ScenarioStarted']>('POST', '/scenarios/runs', start),
  cancelScenario: () => command('POST', '/scenarios/cancel'),
  thesisTables: () => request<ThesisTable[]>('GET', '/comm-tests/tables'),
};
