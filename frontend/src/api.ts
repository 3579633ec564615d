/** The server's HTTP interface. Every call answers `null` or its result, or what went wrong in words. */
import type { components } from './generated/api';
import type { Commands } from './generated/commands';
import type { State } from './generated/topics';
import { command, download, request, send, upload, type Answer } from './http';

export type { Answer, Downloaded } from './http';

type Schemas = components['schemas'];
export type Identity = Schemas['Identity'];
export type Role = Identity['role'];
export type Scope = NonNullable<Schemas['NewToken']['scope']>;
export type CallerDetails = Schemas['CallerDetails'];
export type Device = Schemas['DeviceDetails'];
export type Invitation = Schemas['MadeCode'];
export type Token = Schemas['MadeToken'];
export type AuditEntry = Schemas['AuditEntry'];
export type AuditList = Schemas['AuditList'];
export type Part = Schemas['PartHealth'];
export type LinkFrame = Schemas['Dissection'];
export type LinkFrames = Schemas['LinkFrames'];
export type Session = Schemas['Session'];
export type SessionDetail = Schemas['SessionDetail'];
export type SessionChanges = Partial<Pick<Session, 'name' | 'note' | 'tags' | 'kept'>>;
export type SessionTexts = Partial<Pick<Session, 'name' | 'note' | 'tags'>>;
export type Mark = Schemas['Bookmark'];
export type Storage = Schemas['Storage'];
export type ExportJob = Schemas['Job'];
export type ExportFormat = Schemas['ExportOptions']['format'];
export type ExportCompression = Schemas['ExportOptions']['compression'];
export type ExportSpreadsheet = Schemas['ExportOptions']['spreadsheet'];
export type NewExport = Pick<Schemas['NewExport'], 'session' | 'format'> & Partial<Schemas['NewExport']>;
export type DoorDetails = Schemas['DoorDetails'];
export type Finding = Schemas['Finding'];
export type CommTestDocument = Schemas['TestDocument'];
export type CommTestCheck = Schemas['Check'];
export type EntryProblem = Schemas['EntryProblem'];
export type CommTestPlace = Schemas['CommTestStart']['place'];
export type CommTestSummary = Schemas['RunSummary'];
export type CommTestRun = Schemas['CommTestRunDetails'];
export type Cell = Schemas['Cell'];
export type ScenarioText = Schemas['ScenarioText'];
export type ScenarioSummary = Schemas['ScenarioSummary'];
export type ScenarioEvent = Schemas['ScenarioEvent'];
export type ScenarioCheck = Schemas['ScenarioCheck'];
export type ScenarioState = Schemas['ScenarioState'];
export type ScenarioStart = Schemas['ScenarioStart'];
export type MissionText = Schemas['MissionText'];
export type MissionVersion = Schemas['MissionVersion'];
export type MissionCheck = Schemas['MissionCheck'];
export type MissionNodeKind = Schemas['MissionNodeKind'];
export type MissionTrial = Schemas['MissionTrial'];
export type MissionTrialResult = Schemas['MissionTrialResult'];
export type VisionSettings = Commands['vision_settings'];
export type { ColourRange } from './generated/topics';
export type PickedColour = Schemas['PickedColour'];
export type View = Schemas['SceneView'];
export type Course = Commands['steering']['by'];
export type SavedLayout = Schemas['SavedLayout'];
export type OwnPanel = Schemas['OwnPanel'];
export type ThesisTable = Schemas['ThesisTable'];
export type TuningState = Schemas['TuningState'];
export type TuningRun = Schemas['TuningRun'];
export type TuningRunDetail = Schemas['TuningRunDetail'];
export type TuningRuns = Schemas['TuningRuns'];
export type TuningStart = Schemas['StepStart'] | Schemas['RelayStart'];
export type ActiveTuning = Schemas['ActiveTuning'];
export type Proposal = Schemas['Proposal'];
export type LimitCycle = Schemas['MeasuredLimitCycle'];
export type IdentificationState = Schemas['IdentificationState'];
export type IdentificationResult = Schemas['IdentificationResult'];
export type IdentificationStart = Schemas['IdentificationStart'];
export type CraftChange = Schemas['CraftChange'];
export type LoopName = TuningRun['loop'];
export type ParameterChange = Schemas['Change'];
export type Profile = Schemas['Profile'];
export type ParameterValue = Commands['parameters']['values'][string];
export type Restored = Schemas['Restored'];
/** who drives an armed robot: the pilot or the controller */
export type Piloting = Extract<State['mode'], 'manual' | 'automatic'>;

export type UpdateState = Schemas['UpdateState'];
export type FirmwareUploadState = Schemas['UploadState'];
export type BringUpState = Schemas['BringUpState'];
export type BringUpStep = Schemas['BringUpStep'];
export type BringUpAction = Schemas['BringUpAction'];
export type BringUpResult = Schemas['BringUpResult'];
export type BringUpReadings = Schemas['RawReadings'];
export type BringUpHands = Schemas['BenchHands'];
export type BringUpHandsOrder = Partial<Schemas['HandsOrder']>;
export type BringUpInputs = NonNullable<Schemas['BringUpOrder']['inputs']>;

export type Signal = Schemas['Signal'];
export type Comparison = Schemas['Comparison'];
export type Compared = Schemas['Compared'];
export type ComparedLines = Schemas['Lines'];
export type ComparisonLine = Schemas['SignalLine'];
export type Align = Schemas['Align'];
export type TimeRange = Schemas['TimeRange'];
export type FigureMeaning = Schemas['FigureMeaning'];
export type FigureMark = Schemas['FigureMark'];
export type WantedLines = Schemas['LinesQuery'];
export type WantedComparison = Schemas['ComparisonQuery'];
export type Timeline = Schemas['Timeline'];
export type RecordedMission = Schemas['RecordedMission'];

export interface SessionQuery {
  readonly search?: string;
  readonly tags?: readonly string[];
  readonly deleted?: boolean;
  readonly before?: Session['id'];
}

/** Some of the sessions that match, and how many match. */
export interface SessionsPage {
  readonly sessions: readonly Session[];
  readonly total: number;
}

/** The first missions of a session, and how many more there are. */
export interface SessionMissions {
  readonly missions: readonly RecordedMission[];
  readonly leftOut: number;
}

/** Blocks as on the live socket, and how many samples could not be given. */
export interface Stretch {
  readonly blocks: ArrayBuffer;
  readonly leftOut: number;
}

const TIMEOUT_STOP = 2000;
/** ms; some megabytes */
const TIMEOUT_PAST = 20_000;
/** ms; a check takes up to ten seconds */
const TIMEOUT_CHECK = 15_000;
/** ms; a board may have to be handed over first, or to get its firmware back */
const TIMEOUT_COMM_TEST = 120_000;
/** ms; the robot is armed first */
const TIMEOUT_MISSION = 30_000;
/** ms; hours of recordings are read */
const TIMEOUT_COMPARE = 60_000;

async function readSessions(response: Response): Promise<SessionsPage> {
  return { sessions: (await response.json()) as Session[], total: Number(response.headers.get('Total-Count')) };
}

async function readMissions(response: Response): Promise<SessionMissions> {
  return {
    missions: (await response.json()) as RecordedMission[],
    leftOut: Number(response.headers.get('Left-Out')),
  };
}

async function readStretch(response: Response): Promise<Stretch> {
  return { blocks: await response.arrayBuffer(), leftOut: Number(response.headers.get('Left-Out')) };
}

/** why the robot cannot be commanded from this page now; STOP always can */
let refusal: string | null = null;

/** Refuse every command to the robot but STOP, with this reason, until told otherwise by null. */
export function refuseCommands(reason: string | null): void {
  refusal = reason;
}

function order(method: string, path: string, body?: object, timeout?: number): Promise<string | null> {
  return refusal === null ? command(method, path, body, timeout) : Promise.resolve(refusal);
}

function orderFor<T>(method: string, path: string, body?: object, timeout?: number): Promise<Answer<T>> {
  return refusal === null ? request<T>(method, path, body, timeout) : Promise.resolve({ problem: refusal });
}

/** The spreadsheet of this browser's country: who presses a button for CSV opens it there. */
function ownSpreadsheet(): ExportSpreadsheet {
  return (0.5).toLocaleString().includes(',') ? 'comma' : 'point';
}

export const api = {
  stop: () => command('POST', '/robot/stop', undefined, TIMEOUT_STOP),
  /** Send the robot a command; STOP has its own way. */
  command: <Name extends keyof Commands>(name: Name, fields: Commands[Name]) =>
    order('POST', `/robot/commands/${name}`, fields, name === 'check_fins' ? TIMEOUT_CHECK : undefined),
  takeControl: () => command('POST', '/control/take'),
  releaseControl: () => command('POST', '/control/release'),
  takeControlOver: () => command('POST', '/control/take?over=true'),
  me: () => request<CallerDetails>('GET', '/access/me'),
  pair: (code: string, name: string) => request<Schemas['Paired']>('POST', '/access/pair', { code, name }),
  confirm: (code: string) => command('POST', '/access/confirm', { code }),
  signOut: () => command('POST', '/access/sign-out'),
  invite: (role: Role) => request<Invitation>('POST', '/access/codes', { role }),
  devices: () => request<Device[]>('GET', '/access/devices'),
  changeDevice: (device: number, said: { role?: Role; name?: string }) => command('PATCH', `/access/devices/${device}`, said),
  audit: (query: URLSearchParams) => request<AuditList>('GET', `/audit?${query.toString()}`),
  auditFile: (query: URLSearchParams) => download(`/audit/csv?${query.toString()}&spreadsheet=${ownSpreadsheet()}`, () => undefined),
  revoke: (device: number) => command('DELETE', `/access/devices/${device}`),
  makeToken: (token: Schemas['NewToken']) => request<Token>('POST', '/access/tokens', token),
  visionSettings: () => request<{ settings: VisionSettings; configured: VisionSettings }>('GET', '/vision'),
  /** `base` has the settings that the editing began from; with null, whatever they are by now is replaced */
  editVision: (settings: VisionSettings, base: VisionSettings | null) => orderFor<null>('PUT', '/vision', { settings, base }),
  pick: (place: Schemas['PickPlace']) => request<PickedColour>('POST', '/vision/pick', place),
  visionFile: '/api/vision/toml',
  readVision: (text: string) => request<VisionSettings>('POST', '/vision/read', { text }),
  parameterChanges: () => request<ParameterChange[]>('GET', '/parameters/changes'),
  undoParameters: (change: ParameterChange['id']) => order('POST', '/parameters/undo', { change }),
  profiles: () => request<Profile[]>('GET', '/profiles'),
  saveProfile: (name: string, note: string) => request<Profile>('POST', '/profiles', { name, note }),
  importProfile: (text: string) => request<Schemas['Imported']>('POST', '/profiles/file', { text }),
  restoreProfile: (id: Profile['id']) => orderFor<Restored>('POST', `/profiles/${id}/restore`),
  deleteProfile: (id: Profile['id']) => command('DELETE', `/profiles/${id}`),
  profileFile: (id: Profile['id']) => `/api/profiles/${id}/file`,
  simulator: (here: boolean) => order('PUT', '/simulator', { here }),
  view: (view: View) => order('PUT', '/scene/view', view),
  /** the rows that the server has of these topics up to a time, s, steady clock */
  past: (topics: readonly string[], until: number) =>
    send('GET', `/past?${topics.map((topic) => `topic=${topic}&`).join('')}until=${until}`, undefined, TIMEOUT_PAST, (response) =>
      response.arrayBuffer(),
    ),
  health: () => request<Schemas['Health']>('GET', '/health'),
  linkFrames: () => request<LinkFrames>('GET', '/link/frames'),
  /** some sessions, newest first; with `before` those of lower numbers */
  sessions: ({ tags = [], ...query }: SessionQuery = {}) => {
    const fields = Object.entries(query).map(([name, value]) => [name, String(value)]);
    const written = new URLSearchParams([...fields, ...tags.map((tag) => ['tag', tag])]);
    return send('GET', `/sessions?${written.toString()}`, undefined, undefined, readSessions);
  },
  tags: () => request<string[]>('GET', '/tags'),
  session: (id: Session['id']) => request<SessionDetail>('GET', `/sessions/${id}`),
  /** `base` has the texts that the editing began from; with null, whatever they are by now is replaced */
  changeSession: (id: Session['id'], said: SessionChanges, base: SessionTexts | null) =>
    request<Session>('PATCH', `/sessions/${id}`, { ...said, base }),
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
  backup: (progress: (received: number, total: number) => void) => download('/backup', progress),
  doors: () => request<DoorDetails[]>('GET', '/doors'),
  findings: () => request<Finding[]>('GET', '/doctor'),
  examine: () => request<Finding[]>('POST', '/doctor', undefined, TIMEOUT_COMM_TEST),
  storage: () => request<Storage>('GET', '/storage'),
  startSession: (name: string, note: string) => request<Session>('POST', '/sessions', { name, note }),
  stopSession: (id: Session['id']) => request<Session>('POST', `/sessions/${id}/stop`),
  signals: (id: Session['id']) => request<Signal[]>('GET', `/sessions/${id}/signals`),
  compare: (wanted: WantedComparison) => request<Comparison>('POST', '/compare', wanted, TIMEOUT_COMPARE),
  compareLines: (wanted: WantedLines) => request<ComparedLines>('POST', '/compare/lines', wanted, TIMEOUT_COMPARE),
  compareReport: (query: URLSearchParams) => `/api/compare/report?${query.toString()}`,
  sessionMissions: (id: Session['id']) =>
    send('GET', `/sessions/${id}/missions`, undefined, undefined, readMissions),
  timeline: (id: Session['id']) => request<Timeline>('GET', `/sessions/${id}/timeline`),
  blocks: (id: Session['id'], start: number, end: number, history?: number) =>
    send(
      'GET',
      `/sessions/${id}/blocks?start=${start}&end=${end}${history === undefined ? '' : `&history=${history}`}`,
      undefined,
      undefined,
      readStretch,
    ),
  exports: () => request<ExportJob[]>('GET', '/exports'),
  startExport: (wanted: NewExport) => request<ExportJob>('POST', '/exports', wanted),
  deleteExport: (id: ExportJob['id']) => command('DELETE', `/exports/${id}`),
  exportFile: (id: ExportJob['id']) => `/api/exports/${id}/file`,
  importSession: (file: File, progress: (share: number) => void) => upload<Session>('/imports', file, progress),
  commTestDocuments: () => request<CommTestDocument[]>('GET', '/comm-tests/documents'),
  checkCommTest: (text: string) => request<CommTestCheck>('POST', '/comm-tests/check', { text }),
  startCommTest: (text: string, place: CommTestPlace) =>
    request<Schemas['Started']>('POST', '/comm-tests/runs', { text, place }, TIMEOUT_COMM_TEST),
  cancelCommTest: (run: CommTestRun['id']) => command('POST', `/comm-tests/cancel?run=${run}`, undefined, TIMEOUT_COMM_TEST),
  commTestRuns: () => request<CommTestSummary[]>('GET', '/comm-tests/runs'),
  commTestRun: (id: CommTestRun['id']) => request<CommTestRun>('GET', `/comm-tests/runs/${id}`),
  commTestFile: (id: CommTestRun['id'], format: 'csv' | 'json') =>
    `/api/comm-tests/runs/${id}/${format}${format === 'csv' ? `?spreadsheet=${ownSpreadsheet()}` : ''}`,
  scenarios: () => request<ScenarioText[]>('GET', '/scenarios'),
  keepScenario: (text: string, base: string | null) => request<ScenarioSummary>('POST', '/scenarios', { text, base }),
  checkScenario: (text: string) => request<ScenarioCheck>('POST', '/scenarios/check', { text }),
  startScenario: (start: ScenarioStart) => request<Schemas['ScenarioStarted']>('POST', '/scenarios/runs', start),
  /** this run, or with null the active one and all that wait */
  cancelScenario: (run: string | null) => command('POST', `/scenarios/cancel${run === null ? '' : `?run=${run}`}`),
  missions: () => request<MissionText[]>('GET', '/missions'),
  missionNodes: () => request<MissionNodeKind[]>('GET', '/missions/nodes'),
  missionVersions: (name: MissionText['name']) => request<MissionVersion[]>('GET', `/missions/versions/${name}`),
  checkMission: (text: string) => request<MissionCheck>('POST', '/missions/check', { text }),
  keepMission: (text: string, base: string | null) => request<Schemas['MissionSummary']>('POST', '/missions', { text, base }),
  deleteMission: (name: MissionText['name']) => command('DELETE', `/missions/${name}`),
  startMission: (text: string) => orderFor<Schemas['MissionSummary']>('POST', '/missions/start', { text }, TIMEOUT_MISSION),
  missionTrial: () => request<MissionTrial>('GET', '/missions/trial'),
  startMissionTrial: (text: string, seeds: number) => request<MissionTrial>('POST', '/missions/trial', { text, seeds }),
  cancelMissionTrial: (run: MissionTrial['run']) => command('POST', `/missions/trial/cancel?run=${run}`),
  layouts: () => request<SavedLayout[]>('GET', '/layouts'),
  layout: (id: SavedLayout['id']) => request<Schemas['LayoutDetails']>('GET', `/layouts/${id}`),
  saveLayout: (name: string, document: object, base: number | null) => request<SavedLayout>('POST', '/layouts', { name, document, base }),
  deleteLayout: (id: SavedLayout['id']) => command('DELETE', `/layouts/${id}`),
  ownPanels: () => request<OwnPanel[]>('GET', '/panels'),
  ownPanel: (name: OwnPanel['name']) =>
    request<Schemas['OwnPanelScript']>('GET', `/panels/own/${encodeURIComponent(name)}`),
  identification: () => request<IdentificationState>('GET', '/identification'),
  startIdentification: (wanted: IdentificationStart) => order('POST', '/identification', wanted),
  cancelIdentification: (run: string) => order('POST', `/identification/cancel?run=${run}`),
  adoptCraft: (run: string) => request<CraftChange>('POST', `/identification/adopt?run=${run}`),
  undoCraft: () => request<CraftChange>('POST', '/identification/undo'),
  tuningRuns: (loop: LoopName) => request<TuningRuns>('GET', `/tuning/runs?loop=${loop}`),
  tuningRun: (id: TuningRun['id']) => request<TuningRunDetail>('GET', `/tuning/runs/${id}`),
  startTuning: (wanted: TuningStart) => order('POST', '/tuning/runs', wanted),
  stopTuning: (run: ActiveTuning['run']) => order('POST', `/tuning/stop?run=${run}`),
  renameTuning: (id: TuningRun['id'], name: string) => command('PATCH', `/tuning/runs/${id}`, { name }),
  deleteTuning: (id: TuningRun['id']) => command('DELETE', `/tuning/runs/${id}`),
  firmwareUpload: () => request<FirmwareUploadState>('GET', '/firmware'),
  uploadFirmware: (firmware: Schemas['UploadOrder']['firmware']) =>
    request<FirmwareUploadState>('POST', '/firmware', { firmware }, TIMEOUT_COMM_TEST),
  update: () => request<UpdateState>('GET', '/update'),
  sendRelease: (file: File, progress: (share: number) => void) => upload<UpdateState>('/update/release', file, progress),
  beginUpdate: () => request<UpdateState>('POST', '/update'),
  bringUp: () => request<BringUpState>('GET', '/bring-up'),
  beginBringUp: () => orderFor<BringUpState>('POST', '/bring-up', undefined, TIMEOUT_COMM_TEST),
  endBringUp: (run: BringUpState['run']) => request<BringUpState>('DELETE', `/bring-up?run=${run}`),
  useHandsInBringUp: (order: BringUpHandsOrder) => orderFor<BringUpState>('POST', '/bring-up/hands', order),
  actInBringUp: (run: BringUpState['run'], step: string, action: string, inputs: BringUpInputs) =>
    orderFor<BringUpState>('POST', '/bring-up/actions', { run, step, action, inputs }, TIMEOUT_CHECK),
  thesisTables: () => request<ThesisTable[]>('GET', '/comm-tests/tables'),
};
