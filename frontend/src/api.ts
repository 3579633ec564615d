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
export type ExportJob = Schemas['Job'];
export type ExportFormat = Schemas['Wanted']['format'];
export type NewExport = Pick<Schemas['NewExport'], 'session' | 'format'> & Partial<Schemas['NewExport']>;
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
export type Course = Schemas['Course']['by'];
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
export type WantedLines = Schemas['WantedLines'];
export type WantedComparison = Schemas['WantedComparison'];
export type Timeline = Schemas['Timeline'];

/** Blocks as on the live socket, and how many samples could not be given. */
export interface Stretch {
  readonly blocks: ArrayBuffer;
  readonly leftOut: number;
}

export type Answer<T> = { readonly value: T } | { readonly problem: string };

const TIMEOUT = 5000;
const TIMEOUT_STOP = 2000;
/** ms; a board may have to be handed over first, or to get its firmware back */
const TIMEOUT_COMM_TEST = 120_000;
/** ms; hours of recordings are read */
const TIMEOUT_COMPARE = 60_000;

async function send<T>(
  method: string,
  path: string,
  body: object | undefined,
  timeout: number,
  read: (response: Response) => Promise<T>,
): Promise<Answer<T>> {
  try {
    const response = await fetch(`/api${path}`, {
      method,
      headers: body ? { 'Content-Type': 'application/json' } : {},
      ...(body ? { body: JSON.stringify(body) } : {}),
      signal: AbortSignal.timeout(timeout),
    });
    if (!response.ok) return { problem: describe(response.status, await response.text()) };
    return { value: await read(response) };
  } catch {
    return { problem: 'The server does not answer. Look whether it runs and whether this device is in its network.' };
  }
}

function request<T>(method: string, path: string, body?: object, timeout = TIMEOUT): Promise<Answer<T>> {
  return send(method, path, body, timeout, async (response) => {
    const text = await response.text();
    return (text === '' ? null : JSON.parse(text)) as T;
  });
}

async function readStretch(response: Response): Promise<Stretch> {
  return { blocks: await response.arrayBuffer(), leftOut: Number(response.headers.get('Left-Out')) };
}

/** Fetch tells nothing of how far it has sent a body. */
function upload<T>(path: string, file: File, progress: (share: number) => void): Promise<Answer<T>> {
  return new Promise((resolve) => {
    const sending = new XMLHttpRequest();
    sending.upload.onprogress = (event) => event.lengthComputable && progress(event.loaded / event.total);
    sending.onload = () => {
      if (sending.status >= 400) resolve({ problem: describe(sending.status, sending.responseText) });
      else resolve({ value: JSON.parse(sending.responseText) as T });
    };
    sending.onerror = () => resolve({ problem: `${file.name} could not be sent whole. Look whether the server runs, and try again.` });
    sending.open('POST', `/api${path}`);
    sending.send(file);
  });
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

/** why the robot cannot be commanded from this page now; STOP always can */
let refusal: string | null = null;

/** Refuse every command to the robot but STOP, with this reason, until told otherwise by null. */
export function refuseCommands(reason: string | null): void {
  refusal = reason;
}

function order(method: string, path: string, body?: object): Promise<string | null> {
  return refusal === null ? command(method, path, body) : Promise.resolve(refusal);
}

export const api = {
  stop: () => command('POST', '/robot/stop', undefined, TIMEOUT_STOP),
  arm: () => order('POST', '/robot/arm'),
  controller: (name: string, gains: Record<string, number>) => order('PUT', '/robot/controller', { name, gains }),
  setPoints: (points: Schemas['SetPoints']) => order('PUT', '/robot/set-points', points),
  steering: (by: Course) => order('PUT', '/robot/steering', { by }),
  card: (colour: string | null) => order('PUT', '/robot/card', { colour }),
  vision: (wanted: Schemas['Vision']) => order('PUT', '/robot/vision', wanted),
  simulator: (here: boolean) => order('PUT', '/simulator', { here }),
  view: (view: View) => order('PUT', '/scene/view', view),
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
  timeline: (id: Session['id']) => request<Timeline>('GET', `/sessions/${id}/timeline`),
  blocks: (id: Session['id'], start: number, end: number, history?: number) =>
    send(
      'GET',
      `/sessions/${id}/blocks?start=${start}&end=${end}${history === undefined ? '' : `&history=${history}`}`,
      undefined,
      TIMEOUT,
      readStretch,
    ),
  csv: (id: Session['id']) => `/api/sessions/${id}/csv`,
  exports: () => request<ExportJob[]>('GET', '/exports'),
  startExport: (wanted: NewExport) => request<ExportJob>('POST', '/exports', wanted),
  deleteExport: (id: ExportJob['id']) => command('DELETE', `/exports/${id}`),
  exportFile: (id: ExportJob['id']) => `/api/exports/${id}/file`,
  importSession: (file: File, progress: (share: number) => void) => upload<Session>('/imports', file, progress),
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
