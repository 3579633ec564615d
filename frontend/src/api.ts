/** The server's HTTP interface. Every call answers `null` or its result, or what went wrong in words. */
import type * as schemas from './generated/api';
import type { operations, paths } from './generated/api';
import type { State } from './generated/topics';
import { address, ask, askFor, bytes, command, download, robot, server, unlessBarred, upload, within } from './http';

export type * from './generated/api';
export { refuseCommands, type Answer } from './http';

export type Role = schemas.Identity['role'];
export type Scope = NonNullable<schemas.NewToken['scope']>;
export type SessionTexts = Partial<Pick<schemas.Session, 'name' | 'note' | 'tags'>>;
export type SessionEdit = SessionTexts & Partial<Pick<schemas.Session, 'kept'>>;
export type SessionQuery = NonNullable<operations['listSessions']['parameters']['query']>;
export type FigureQuery = NonNullable<operations['getFigureStudy']['parameters']['query']>;
type SessionGroupsQuery = operations['listSessionGroups']['parameters']['query'];
export type SessionGrouping = NonNullable<SessionQuery['by']>;
type AuditQuery = NonNullable<operations['listAudit']['parameters']['query']>;
type ReportQuery = operations['getComparisonReport']['parameters']['query'];
export type ExportFormat = schemas.ExportOptions['format'];
export type ExportCompression = schemas.ExportOptions['compression'];
export type ExportOverlay = NonNullable<schemas.ExportOptions['overlay']>;
export type ExportSpreadsheet = schemas.ExportOptions['spreadsheet'];
export type ExportJob = schemas.Job;
export type CommTestDocument = schemas.TestDocument;
export type CommTestCheck = schemas.Check;
export type CommTestSummary = schemas.RunSummary;
export type CommTestPlace = schemas.CommTestStart['place'];
/** All of them: only an older client leaves some out. */
export type VisionSettings = { [Name in keyof schemas.VisionSettingsCommand]-?: NonNullable<schemas.VisionSettingsCommand[Name]> };
export type ColourRange = schemas.ColourRangeOutput;
export type Course = schemas.SteeringCommand['by'];
export type TuningStart = schemas.StepStart | schemas.RelayStart;
export type LoopName = schemas.TuningRun['loop'];
export type ParameterChange = schemas.Change;
export type ParameterValue = schemas.ParametersCommand['values'][string];
/** who drives an armed robot: the pilot or the controller */
export type Piloting = Extract<State['mode'], 'manual' | 'automatic'>;
export type BringUpInputs = NonNullable<schemas.BringUpOrder['inputs']>;
export type LinkFrame = schemas.Dissection;

type CommandPath = Extract<keyof paths, `/api/robot/commands/${string}`>;
type CommandName = CommandPath extends `/api/robot/commands/${infer Name}` ? Name : never;
type Fields<Operation> = Operation extends { requestBody?: { content: { 'application/json': infer Body } } } ? NonNullable<Body> : never;
/** The fields of each command, by its name. */
type Commands = { [Name in CommandName]: Fields<paths[`/api/robot/commands/${Name}`]['post']> };

/** The first missions of a session, and how many more there are. */
export interface SessionMissions {
  readonly missions: readonly schemas.RecordedMission[];
  readonly leftOut: number;
}

/** A part of a film as an MP4 file, which begins `start` s after the session. */
export interface FilmPart {
  readonly data: ArrayBuffer;
  readonly start: number;
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
const TIMEOUT_BOARD = 120_000;
/** ms; the robot is armed first */
const TIMEOUT_MISSION = 30_000;
/** ms; the lab makes a certificate meanwhile */
const TIMEOUT_JOIN = 30_000;
/** ms; hours of recordings are read */
const TIMEOUT_COMPARE = 60_000;

const leftOut = (response: Response) => Number(response.headers.get('Left-Out'));

/** The spreadsheet of this browser's country: who presses a button for CSV opens it there. */
function ownSpreadsheet(): ExportSpreadsheet {
  return (0.5).toLocaleString().includes(',') ? 'comma' : 'point';
}

export const api = {
  stop: () => command(server.POST('/api/robot/stop', { fetch: within(TIMEOUT_STOP) })),
  /** Send the robot a command; STOP has its own way. */
  command: <Name extends CommandName>(name: Name, body: Commands[Name]) =>
    command(robot.POST(`/api/robot/commands/${name}` as CommandPath, { body, ...(name === 'check_fins' ? { fetch: unlessBarred(TIMEOUT_CHECK) } : {}) })),
  takeControl: () => command(server.POST('/api/control/take')),
  takeControlOver: () => command(server.POST('/api/control/take', { params: { query: { over: true } } })),
  releaseControl: () => command(server.POST('/api/control/release')),
  simulator: (here: boolean) => command(robot.PUT('/api/simulator', { body: { here } })),
  view: (body: schemas.SceneView) => command(robot.PUT('/api/scene/view', { body })),

  me: () => ask(server.GET('/api/access/me')),
  pair: (code: string, name: string) => ask(server.POST('/api/access/pair', { body: { code, name } })),
  confirm: (code: string) => command(server.POST('/api/access/confirm', { body: { code } })),
  signOut: () => command(server.POST('/api/access/sign-out')),
  invite: (role: Role) => ask(server.POST('/api/access/codes', { body: { role } })),
  devices: () => ask(server.GET('/api/access/devices')),
  changeDevice: (device: number, body: schemas.DeviceChanges) => command(server.PATCH('/api/access/devices/{device}', { params: { path: { device } }, body })),
  revoke: (device: number) => command(server.DELETE('/api/access/devices/{device}', { params: { path: { device } } })),
  makeToken: (body: schemas.NewToken) => ask(server.POST('/api/access/tokens', { body })),
  openReadingLink: (token: string) => ask(server.POST('/api/access/read', { body: { token } })),
  readingLinks: (session: number) => ask(server.GET('/api/access/reading-links', { params: { query: { session } } })),
  /** `ends` in s since 1970 */
  makeReadingLink: (session: number, ends: number) => ask(server.POST('/api/access/reading-links', { body: { session, ends } })),
  endReadingLink: (link: number) => command(server.DELETE('/api/access/reading-links/{link}', { params: { path: { link } } })),
  audit: (query: AuditQuery) => ask(server.GET('/api/audit', { params: { query } })),
  auditFile: (query: AuditQuery) =>
    download(server.GET('/api/audit/csv', { params: { query: { ...query, spreadsheet: ownSpreadsheet() } }, parseAs: 'stream', fetch: within(null) })),

  roster: () => ask(server.GET('/api/robots')),
  pulls: () => ask(server.GET('/api/lab/pulls')),
  makeJoiningCode: () => ask(server.POST('/api/robots/codes')),
  stopAll: () => ask(server.POST('/api/robots/stop')),
  removeRobot: (robot: string) => command(server.DELETE('/api/robots/{robot}', { params: { path: { robot } } })),
  lab: () => ask(server.GET('/api/lab')),
  joinLab: (address: string, code: string) => ask(server.POST('/api/lab/join', { body: { address, code }, fetch: within(TIMEOUT_JOIN) })),
  leaveLab: () => ask(server.DELETE('/api/lab')),

  visionSettings: () => ask(server.GET('/api/vision')),
  /** `base` has the settings that the editing began from; with null, whatever they are by now is replaced */
  editVision: (settings: VisionSettings, base: VisionSettings | null) => ask(robot.PUT('/api/vision', { body: { settings, base } })),
  pick: (body: schemas.PickPlace) => ask(server.POST('/api/vision/pick', { body })),
  visionFile: address('/api/vision/toml', {}),
  readVision: (text: string) => ask(server.POST('/api/vision/read', { body: { text } })),

  parameterChanges: () => ask(server.GET('/api/parameters/changes')),
  undoParameters: (change: number) => command(robot.POST('/api/parameters/undo', { body: { change } })),
  profiles: () => ask(server.GET('/api/profiles')),
  saveProfile: (name: string, note: string) => ask(server.POST('/api/profiles', { body: { name, note } })),
  importProfile: (text: string) => ask(server.POST('/api/profiles/file', { body: { text } })),
  restoreProfile: (profile: number) => ask(robot.POST('/api/profiles/{profile}/restore', { params: { path: { profile } } })),
  deleteProfile: (profile: number) => command(server.DELETE('/api/profiles/{profile}', { params: { path: { profile } } })),
  profileFile: (profile: number) => address('/api/profiles/{profile}/file', { path: { profile } }),

  health: () => ask(server.GET('/api/health')),
  linkFrames: () => ask(server.GET('/api/link/frames')),
  doors: () => ask(server.GET('/api/doors')),
  findings: () => ask(server.GET('/api/doctor')),
  examine: () => ask(server.POST('/api/doctor', { fetch: within(TIMEOUT_BOARD) })),
  storage: () => ask(server.GET('/api/storage')),
  backup: (progress: (received: number, total: number) => void) => download(server.GET('/api/backup', { parseAs: 'stream', fetch: within(null) }), progress),
  firmwareUpload: () => ask(server.GET('/api/firmware')),
  uploadFirmware: (firmware: schemas.UploadOrder['firmware']) => ask(server.POST('/api/firmware', { body: { firmware }, fetch: within(TIMEOUT_BOARD) })),
  update: () => ask(server.GET('/api/update')),
  sendRelease: (file: File, progress: (share: number) => void) => upload('/api/update/release', file, progress),
  beginUpdate: () => ask(server.POST('/api/update')),

  /** the rows that the server has of these topics up to a time, s, steady clock */
  past: (topic: readonly string[], until: number) =>
    askFor(server.GET('/api/past', { params: { query: { topic: [...topic], until } }, parseAs: 'arrayBuffer', fetch: within(TIMEOUT_PAST) }), bytes),
  /** some sessions, newest first; with `before` those of lower numbers */
  sessions: (query: SessionQuery = {}) =>
    askFor(server.GET('/api/sessions', { params: { query } }), (sessions, { headers }) => ({ sessions, total: Number(headers.get('Total-Count')) })),
  tags: () => ask(server.GET('/api/tags')),
  sessionGroups: (query: SessionGroupsQuery) => ask(server.GET('/api/sessions/groups', { params: { query } })),
  sessionControllers: () => ask(server.GET('/api/sessions/controllers')),
  sessionRobots: () => ask(server.GET('/api/sessions/robots')),
  figures: (query: FigureQuery) => ask(server.GET('/api/figures', { params: { query } })),
  session: (session: number) => ask(server.GET('/api/sessions/{session}', { params: { path: { session } } })),
  /** `base` has the texts that the editing began from; with null, whatever they are by now is replaced */
  changeSession: (session: number, changes: SessionEdit, base: SessionTexts | null) =>
    ask(server.PATCH('/api/sessions/{session}', { params: { path: { session } }, body: { ...changes, base } })),
  startSession: (name: string, note: string) => ask(server.POST('/api/sessions', { body: { name, note } })),
  stopSession: (session: number) => ask(server.POST('/api/sessions/{session}/stop', { params: { path: { session } } })),
  deleteSession: (session: number) => ask(server.DELETE('/api/sessions/{session}', { params: { path: { session } } })),
  restoreSession: (session: number) => ask(server.POST('/api/sessions/{session}/restore', { params: { path: { session } } })),
  purgeSession: (session: number) => command(server.POST('/api/sessions/{session}/purge', { params: { path: { session } } })),
  /** `time` in s since the session's start; null marks this very moment of one that records */
  addMark: (session: number, time: number | null, text: string) =>
    ask(server.POST('/api/sessions/{session}/markers', { params: { path: { session } }, body: { time, text } })),
  changeMark: (session: number, mark: number, body: schemas.BookmarkChanges) =>
    ask(server.PATCH('/api/sessions/{session}/markers/{mark}', { params: { path: { session, mark } }, body })),
  removeMark: (session: number, mark: number) => command(server.DELETE('/api/sessions/{session}/markers/{mark}', { params: { path: { session, mark } } })),
  takeSnapshot: () => ask(server.POST('/api/snapshots')),
  /** the snapshots of a session after a time, s since its start; with null from the first one on */
  snapshots: (session: number, after: number | null) =>
    ask(server.GET('/api/sessions/{session}/snapshots', { params: { path: { session }, query: after === null ? {} : { after } } })),
  snapshotPicture: (session: number, time: number) => address('/api/sessions/{session}/snapshot', { path: { session }, query: { time } }),
  thumbnail: (session: number, time: number) => address('/api/sessions/{session}/thumbnail', { path: { session }, query: { time } }),
  filmPlan: () => ask(server.GET('/api/film')),
  chooseFilm: (body: schemas.FilmOrder) => command(server.PUT('/api/film', { body })),
  film: (session: number) => ask(server.GET('/api/sessions/{session}/film', { params: { path: { session } } })),
  /** from the picture on that is shown at `start`, s since the session's start */
  filmPart: (session: number, start: number, seconds: number) =>
    askFor(
      server.GET('/api/sessions/{session}/film/part', { params: { path: { session }, query: { start, seconds } }, parseAs: 'arrayBuffer', fetch: within(TIMEOUT_PAST) }),
      (data, { headers }): FilmPart => ({ data: bytes(data), start: Number(headers.get('Film-Start')) }),
    ),
  sessionMissions: (session: number) =>
    askFor(server.GET('/api/sessions/{session}/missions', { params: { path: { session } } }), (missions, response) => ({ missions, leftOut: leftOut(response) })),
  timeline: (session: number) => ask(server.GET('/api/sessions/{session}/timeline', { params: { path: { session } } })),
  blocks: (session: number, start: number, end: number, history: number | null = null) =>
    askFor(
      server.GET('/api/sessions/{session}/blocks', { params: { path: { session }, query: { start, end, history } }, parseAs: 'arrayBuffer' }),
      (blocks, response): Stretch => ({ blocks: bytes(blocks), leftOut: leftOut(response) }),
    ),
  signals: (session: number) => ask(server.GET('/api/sessions/{session}/signals', { params: { path: { session } } })),
  /** of a part, s since the session's start, or of the whole session */
  spectrum: (session: number, signal: string[], part: { start: number; end: number } | null) =>
    ask(server.GET('/api/sessions/{session}/spectrum', { params: { path: { session }, query: { signal, ...(part && { from: part.start, to: part.end }) } }, fetch: within(TIMEOUT_COMPARE) })),
  /** one signal against another, as `spectrum` */
  pairSignals: (session: number, x: string, y: string, part: { start: number; end: number } | null) =>
    ask(server.GET('/api/sessions/{session}/pair', { params: { path: { session }, query: { x, y, ...(part && { from: part.start, to: part.end }) } }, fetch: within(TIMEOUT_COMPARE) })),
  story: (session: number) => ask(server.GET('/api/sessions/{session}/story', { params: { path: { session } }, fetch: within(TIMEOUT_COMPARE) })),
  /** of the whole dive and its segments, or of a part alone, s since the session's start */
  storyFigures: (session: number, part: { start: number; end: number } | null) =>
    ask(server.GET('/api/sessions/{session}/story/figures', { params: { path: { session }, query: part === null ? {} : { from: part.start, to: part.end } }, fetch: within(TIMEOUT_COMPARE) })),
  track: (session: number) => ask(server.GET('/api/sessions/{session}/track', { params: { path: { session } }, fetch: within(TIMEOUT_COMPARE) })),
  readings: (session: number, time: number) => ask(server.GET('/api/sessions/{session}/readings', { params: { path: { session }, query: { time } } })),
  compare: (body: schemas.ComparisonQuery) => ask(server.POST('/api/compare', { body, fetch: within(TIMEOUT_COMPARE) })),
  compareLines: (body: schemas.LinesQuery) => ask(server.POST('/api/compare/lines', { body, fetch: within(TIMEOUT_COMPARE) })),
  compareReport: (query: ReportQuery) => address('/api/compare/report', { query }),
  exports: () => ask(server.GET('/api/exports')),
  startExport: (body: schemas.NewExport) => ask(server.POST('/api/exports', { body })),
  deleteExport: (id: string) => command(server.DELETE('/api/exports/{export}', { params: { path: { export: id } } })),
  exportFile: (id: string) => address('/api/exports/{export}/file', { path: { export: id } }),
  importSession: (file: File, progress: (share: number) => void) => upload('/api/imports', file, progress),

  commTestDocuments: () => ask(server.GET('/api/comm-tests/documents')),
  checkCommTest: (text: string) => ask(server.POST('/api/comm-tests/check', { body: { text } })),
  startCommTest: (text: string, place: CommTestPlace) => ask(server.POST('/api/comm-tests/runs', { body: { text, place }, fetch: within(TIMEOUT_BOARD) })),
  cancelCommTest: (run: number) => command(server.POST('/api/comm-tests/cancel', { params: { query: { run } }, fetch: within(TIMEOUT_BOARD) })),
  commTestRuns: () => ask(server.GET('/api/comm-tests/runs')),
  commTestRun: (run: number) => ask(server.GET('/api/comm-tests/runs/{run}', { params: { path: { run } } })),
  commTestFile: (run: number, format: 'csv' | 'json') =>
    format === 'csv'
      ? address('/api/comm-tests/runs/{run}/csv', { path: { run }, query: { spreadsheet: ownSpreadsheet() } })
      : address('/api/comm-tests/runs/{run}/json', { path: { run } }),
  thesisTables: () => ask(server.GET('/api/comm-tests/tables')),

  scenarios: () => ask(server.GET('/api/scenarios')),
  keepScenario: (text: string, base: string | null) => ask(server.POST('/api/scenarios', { body: { text, base } })),
  scenarioEvents: () => ask(server.GET('/api/scenarios/events')),
  checkScenario: (text: string) => ask(server.POST('/api/scenarios/check', { body: { text } })),
  startScenario: (body: schemas.ScenarioStart) => ask(server.POST('/api/scenarios/runs', { body })),
  /** this run, or with null the active one and all that wait */
  cancelScenario: (run: string | null) => command(server.POST('/api/scenarios/cancel', { params: { query: { run } } })),

  missions: () => ask(server.GET('/api/missions')),
  missionNodes: () => ask(server.GET('/api/missions/nodes')),
  missionVersions: (name: string) => ask(server.GET('/api/missions/versions/{name}', { params: { path: { name } } })),
  checkMission: (text: string) => ask(server.POST('/api/missions/check', { body: { text } })),
  keepMission: (text: string, base: string | null) => ask(server.POST('/api/missions', { body: { text, base } })),
  deleteMission: (name: string) => command(server.DELETE('/api/missions/{name}', { params: { path: { name } } })),
  missionRuns: (name: string) => ask(server.GET('/api/missions/runs/{name}', { params: { path: { name } } })),
  startMission: (text: string) => ask(robot.POST('/api/missions/start', { body: { text }, fetch: unlessBarred(TIMEOUT_MISSION) })),
  missionTrial: () => ask(server.GET('/api/missions/trial')),
  startMissionTrial: (text: string, seeds: number) => ask(server.POST('/api/missions/trial', { body: { text, seeds } })),
  cancelMissionTrial: (run: schemas.MissionTrial['run']) => command(server.POST('/api/missions/trial/cancel', { params: { query: { run } } })),

  layouts: () => ask(server.GET('/api/layouts')),
  layout: (layout: number) => ask(server.GET('/api/layouts/{layout}', { params: { path: { layout } } })),
  saveLayout: (name: string, document: schemas.LayoutDocument, base: number | null) => ask(server.POST('/api/layouts', { body: { name, document, base } })),
  deleteLayout: (layout: number) => command(server.DELETE('/api/layouts/{layout}', { params: { path: { layout } } })),
  ownPanels: () => ask(server.GET('/api/panels')),
  ownPanel: (panel: string) => ask(server.GET('/api/panels/own/{panel}', { params: { path: { panel } } })),

  identification: () => ask(server.GET('/api/identification')),
  startIdentification: (body: schemas.IdentificationStart) => command(robot.POST('/api/identification', { body })),
  cancelIdentification: (run: string) => command(robot.POST('/api/identification/cancel', { params: { query: { run } } })),
  adoptCraft: (run: string) => ask(server.POST('/api/identification/adopt', { params: { query: { run } } })),
  undoCraft: () => ask(server.POST('/api/identification/undo')),
  tuningRuns: (loop: LoopName) => ask(server.GET('/api/tuning/runs', { params: { query: { loop } } })),
  tuningRun: (run: number) => ask(server.GET('/api/tuning/runs/{run}', { params: { path: { run } } })),
  predictStep: (body: schemas.PredictionQuery) => ask(server.POST('/api/tuning/prediction', { body, fetch: within(TIMEOUT_PAST) })),
  startTuning: (body: TuningStart) => command(robot.POST('/api/tuning/runs', { body })),
  stopTuning: (run: number) => command(robot.POST('/api/tuning/stop', { params: { query: { run } } })),
  renameTuning: (run: number, name: string) => command(server.PATCH('/api/tuning/runs/{run}', { params: { path: { run } }, body: { name } })),
  deleteTuning: (run: number) => command(server.DELETE('/api/tuning/runs/{run}', { params: { path: { run } } })),

  bringUp: () => ask(server.GET('/api/bring-up')),
  beginBringUp: () => ask(robot.POST('/api/bring-up', { fetch: unlessBarred(TIMEOUT_BOARD) })),
  endBringUp: (run: schemas.BringUpState['run']) => ask(server.DELETE('/api/bring-up', { params: { query: { run } } })),
  useHandsInBringUp: (body: schemas.HandsOrder) => ask(robot.POST('/api/bring-up/hands', { body })),
  actInBringUp: (run: schemas.BringUpState['run'], step: string, action: string, inputs: BringUpInputs) =>
    ask(robot.POST('/api/bring-up/actions', { body: { run, step, action, inputs }, fetch: unlessBarred(TIMEOUT_CHECK) })),
};
