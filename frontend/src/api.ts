/** The server's HTTP interface. Every call answers `null` or its result, or what went wrong in words. */
import type { components } from './generated/api';

type Schemas = components['schemas'];
export type Part = Schemas['PartHealth'];
export type LinkFrame = Schemas['LinkFrame'];
export type LinkFrames = Schemas['LinkFrames'];
export type Session = Schemas['Session'];
export type SessionDetail = Schemas['SessionDetail'];
export type SessionChanges = Partial<Pick<Session, 'name' | 'note' | 'tags' | 'kept'>>;
export type Mark = Schemas['Mark'];
export type Storage = Schemas['Storage'];
export type CommTestDocument = Schemas['TestDocument'];
export type CommTestCheck = Schemas['Check'];
export type CommTestPlace = Schemas['Start']['place'];
export type CommTestSummary = Schemas['RunSummary'];
export type CommTestRun = Schemas['Run'];
export type Cell = Schemas['Cell'];
export type ThesisTable = Schemas['ThesisTable'];

export type Signal = Schemas['Signal'];
export type Comparison = Schemas['Comparison'];
export type Compared = Schemas['Compared'];
export type ComparedLines = Schemas['Lines'];
export type ComparisonLine = Schemas['Line'];
export type Align = Schemas['Align'];
export type TimeRange = Schemas['TimeRange'];
export type FigureMeaning = Schemas['FigureMeaning'];
export type FigureMark = Schemas['FigureMark'];
export type WantedLines = Schemas['Wanted'];
export type WantedComparison = Schemas['WantedComparison'];

export type Answer<T> = { readonly value: T } | { readonly problem: string };

const TIMEOUT = 5000;
const TIMEOUT_STOP = 2000;
/** ms; a board may have to be handed over first, or to get its firmware back */
const TIMEOUT_COMM_TEST = 120_000;
/** ms; hours of recordings are read */
const TIMEOUT_COMPARE = 60_000;

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
  health: () => request<Schemas['Health']>('GET', '/health'),
  linkFrames: () => request<LinkFrames>('GET', '/link/frames'),
  sessions: (deleted = false) => request<Session[]>('GET', `/sessions?deleted=${deleted}`),
  session: (id: Session['id']) => request<SessionDetail>('GET', `/sessions/${id}`),
  changeSession: (id: Session['id'], said: SessionChanges) => request<Session>('PATCH', `/sessions/${id}`, said),
  deleteSession: (id: Session['id']) => request<Session>('DELETE', `/sessions/${id}`),
  restoreSession: (id: Session['id']) => request<Session>('POST', `/sessions/${id}/restore`),
  purgeSession: (id: Session['id']) => command('POST', `/sessions/${id}/purge`),
  /** `time` in s since the session's start; null marks this very moment of one that records */
  addMark: (id: Session['id'], time: number | null, text: string) =>
    request<Mark>('POST', `/sessions/${id}/markers`, { time, text }),
  changeMark: (id: Session['id'], mark: Mark['id'], said: Partial<Pick<Mark, 'time' | 'text'>>) =>
    request<Mark>('PATCH', `/sessions/${id}/markers/${mark}`, said),
  removeMark: (id: Session['id'], mark: Mark['id']) => command('DELETE', `/sessions/${id}/markers/${mark}`),
  thumbnail: (id: Session['id'], time: number) => `/api/sessions/${id}/thumbnail?time=${time}`,
  storage: () => request<Storage>('GET', '/storage'),
  startSession: (name: string, note: string) => request<Session>('POST', '/sessions', { name, note }),
  stopSession: (id: Session['id']) => request<Session>('POST', `/sessions/${id}/stop`),
  signals: (id: Session['id']) => request<Signal[]>('GET', `/sessions/${id}/signals`),
  compare: (wanted: WantedComparison) => request<Comparison>('POST', '/compare', wanted, TIMEOUT_COMPARE),
  compareLines: (wanted: WantedLines) => request<ComparedLines>('POST', '/compare/lines', wanted, TIMEOUT_COMPARE),
  compareReport: (query: URLSearchParams) => `/api/compare/report?${query.toString()}`,
  csv: (id: Session['id']) => `/api/sessions/${id}/csv`,
  commTestDocuments: () => request<CommTestDocument[]>('GET', '/comm-tests/documents'),
  checkCommTest: (text: string) => request<CommTestCheck>('POST', '/comm-tests/check', { text }),
  startCommTest: (text: string, place: CommTestPlace) =>
    request<Schemas['Started']>('POST', '/comm-tests/runs', { text, place }, TIMEOUT_COMM_TEST),
  cancelCommTest: () => command('POST', '/comm-tests/cancel', undefined, TIMEOUT_COMM_TEST),
  commTestRuns: () => request<CommTestSummary[]>('GET', '/comm-tests/runs'),
  commTestRun: (id: CommTestRun['id']) => request<CommTestRun>('GET', `/comm-tests/runs/${id}`),
  commTestFile: (id: CommTestRun['id'], format: 'csv' | 'json') => `/api/comm-tests/runs/${id}/${format}`,
  thesisTables: () => request<ThesisTable[]>('GET', '/comm-tests/tables'),
};
