import { createContext } from 'svelte';
import {
  OTHER_TOPICS,
  type Alarm,
  type CalibrationKept,
  type DebugLine,
  type Detection,
  type Mission,
  type TunableParameter,
  type Parameters,
  type RobotEvent,
  type Rows,
  type State,
  type VisionInForce,
} from '../generated/topics';
import { readDocuments, readPicture, type Block } from './blocks';
import { calendar, type Instant } from './clock';
import { groupAlarms, membersOf, type AlarmGroup } from './alarms';
import type { Control } from './control.svelte';
import { CommTestWatch } from './comm_test.svelte';
import { freshness, worst, type Freshness } from './freshness';
import { Lines } from './lines.svelte';
import type { Part, ScenarioState, Session, TuningState } from '../api';
import type { Hello } from './messages';
import { Pace } from './pace';
import { OBSERVER_PERIOD, PERIODS, THUMBNAIL_PERIOD, type Timed } from './periods';
import type { Stop } from './stop.svelte';
import { createRings, Gaps } from './store';
import { connection } from '../texts/connection';

/** s from one frame in which something new is drawn to the next */
const FRAME = 0.03;
const TICK_EVERY = 125;
const CONSOLE_LINES = 2000;
const EVENT_LINES = 500;
/** how many detections a rate is counted over */
const RATE_OVER = 12;

const WATCHED = ['observer', 'mask', 'balanced'] as const;
type WatchedPicture = (typeof WATCHED)[number];

export interface Picture {
  readonly time: number;
  readonly jpeg: Blob;
}

/** Everything the page shows of the robot. It comes from the live socket (feed.ts) or from a replay. */
export class Live {
  connection = $state<'connecting' | 'open' | 'lost'>('connecting');
  /** why the server ended the connection, where it said so */
  farewell = $state('');
  /** whether the page comes by TLS and the live connection does not: the browser may distrust the certificate for it */
  untrusted = $state(false);
  /** ms to the server and back; null while unknown */
  roundTrip = $state<number | null>(null);
  hello = $state.raw<Hello | null>(null);
  /** true where the server has this feature on; before it has said so, also */
  has = (feature: string): boolean => this.hello?.features.includes(feature) ?? true;
  /** a moment that is known on both the steady clock and the calendar */
  instant = $state.raw<Instant | null>(null);
  outdated = $state(false);
  parts = $state.raw<readonly Part[]>([]);
  recording = $state.raw<Session | null>(null);
  state = $state.raw<State | null>(null);
  /** everything that may be tuned; null until the runtime has told of it */
  parameters = $state.raw<readonly TunableParameter[] | null>(null);
  /** null until the runtime has told what it knows of the board's */
  calibration = $state.raw<CalibrationKept | null>(null);
  detection = $state.raw<Detection | null>(null);
  /** Hz, as detections really come; null while there are fewer than two */
  detectionRate = $state<number | null>(null);
  picture = $state.raw<Picture | null>(null);
  /** what a bystander in the simulated water sees; comes only while somebody asked for it with `watch` */
  observer = $state.raw<Picture | null>(null);
  /** the mask of the wanted colour, and the picture after the white balance; while somebody asked for them */
  mask = $state.raw<Picture | null>(null);
  balanced = $state.raw<Picture | null>(null);
  /** the running mission, or the last one; null where none is known */
  mission = $state.raw<Mission | null>(null);
  /** how the vision node looks */
  vision = $state.raw<VisionInForce | null>(null);
  serverError = $state('');
  /** alarms of the server, which sees what the runtime cannot: that it is silent, for one */
  serverAlarms = $state.raw<readonly Alarm[]>([]);
  readonly rings = createRings();
  readonly debug = new Lines<DebugLine>(CONSOLE_LINES);
  readonly events = new Lines<RobotEvent>(EVENT_LINES, (one, other) => one.time - other.time);
  readonly gaps = new Gaps();
  readonly commTest = new CommTestWatch();
  /** null until the server has said whether a scenario runs */
  scenario = $state.raw<ScenarioState | null>(null);
  /** null until the server has said whether an experiment runs */
  tuning = $state.raw<TuningState | null>(null);

  /** counts frames in which something new is to be drawn, and the slower beat at which digits are read */
  #detected: number[] = [];
  #frame = $state(0);
  #tick = $state(0);
  readonly #pace = new Pace();
  #awaited = false;
  /** whether the board's samples came since the last frame: it is drawn with them */
  #sampled = false;
  readonly #watching: Record<WatchedPicture, number> = { observer: 0, mask: 0, balanced: 0 };
  /** called where `watched` changes; a recording has no such pictures */
  onWatch: (() => void) | null = null;
  /** somebody looks at a topic before its ring begins */
  wantPast: (topic: keyof Rows) => void = () => undefined;

  /**
   * @param clock the steady clock of what is shown, s; NaN while unknown
   * @param control null where this shows the past, where nothing can be commanded
   */
  constructor(
    private readonly clock: () => number,
    readonly stop: Stop,
    readonly control: Control | null,
  ) {}

  /** whether this shows the past */
  get replayed(): boolean {
    return this.control === null;
  }

  /** Why the robot cannot be commanded from here, in words; null where it can. STOP always can. */
  get barred(): string | null {
    return this.control === null ? connection.barred.replay : this.control.barred;
  }

  /** Present alarms, and past ones that nobody has acknowledged, beneath their causes; the most urgent first. */
  get alarmGroups(): readonly AlarmGroup[] {
    return groupAlarms([...(this.state?.alarms ?? []), ...this.serverAlarms]);
  }

  /** The same, one after the other. */
  get alarms(): readonly Alarm[] {
    return this.alarmGroups.flatMap(membersOf);
  }

  /** whether nobody knows if this alarm is active still: who raised it, server or runtime, says nothing */
  isUnknown(alarm: Alarm): boolean {
    if (this.replayed) return false;
    if (this.connection !== 'open') return true;
    return this.freshness('state').state === 'stale' && this.state?.alarms.includes(alarm) === true;
  }

  /** Let time pass for what is read at leisure. Returns what ends it. */
  beat(): () => void {
    const beat = setInterval(() => {
      this.#tick += 1;
      // Nothing arrives while a replay rests, but a chart may have got another size.
      if (this.replayed) this.redraw();
    }, TICK_EVERY);
    return () => clearInterval(beat);
  }

  /** Look at pictures that are made only for whoever does. Returns what ends that. */
  watch(topic: WatchedPicture): () => void {
    this.#watching[topic] += 1;
    if (this.#watching[topic] === 1) this.onWatch?.();
    return () => {
      this.#watching[topic] -= 1;
      if (this.#watching[topic] > 0) return;
      this[topic] = null;
      this.onWatch?.();
    };
  }

  /** the pictures that somebody looks at beside the camera's */
  get watched(): WatchedPicture[] {
    return WATCHED.filter((topic) => this.#watching[topic] > 0);
  }

  /** The robot's steady clock, s; NaN while unknown. Whoever reads it in an effect runs again with every tick. */
  get now(): number {
    void this.#tick;
    return this.clock();
  }

  /** As `now`, not reactive: for callers that run at each frame anyway. */
  get instantNow(): number {
    return this.clock();
  }

  /** As `now`, for what is drawn with every frame. */
  get frameNow(): number {
    void this.#frame;
    return this.clock();
  }

  /** The newest row of a topic, as often as the screen is drawn. */
  row<K extends keyof Rows>(topic: K): Rows[K] | null {
    void this.#frame;
    return (this.rings[topic] as { latest(): Rows[K] | null }).latest();
  }

  /** The newest row of a topic, at a pace that eyes can read. */
  reading<K extends keyof Rows>(topic: K): Rows[K] | null {
    void this.#tick;
    return (this.rings[topic] as { latest(): Rows[K] | null }).latest();
  }

  freshness(...topics: Timed[]): Freshness {
    const now = this.now;
    return worst(topics.map((topic) => freshness(this.#newest(topic), now, this.period(topic))));
  }

  /** The instant of a steady time by the calendar of the robot's computer. */
  date(steady: number): Date {
    return calendar(steady, this.instant);
  }

  /** s on the robot's clock since an ISO 8601 time that its computer gave; 0 while that clock is not known. */
  since(time: string): number {
    const seconds = (this.date(this.now).getTime() - Date.parse(time)) / 1000;
    return Number.isFinite(seconds) ? seconds : 0;
  }

  #newest(topic: Timed): number | null {
    if (topic === 'state') return this.state?.time ?? null;
    if (topic === 'detection') return this.detection?.time ?? null;
    if (topic === 'picture') return this.picture?.time ?? null;
    if (topic === 'observer') return this.observer?.time ?? null;
    if (topic === 'mask') return this.mask?.time ?? null;
    return this.rings[topic].newest;
  }

  /** s between two samples of a topic as things are */
  period(topic: Timed): number {
    if (topic === 'picture' && this.replayed) return THUMBNAIL_PERIOD;
    if (topic === 'detection' || topic === 'picture' || topic === 'mask') return 1 / (this.state?.vision_rate ?? 1);
    if (topic === 'observer') return OBSERVER_PERIOD;
    if (topic === 'control' || topic === 'turning' || topic === 'navigation') return 1 / (this.state?.control_rate ?? 10);
    return this.state?.paces.find((pace) => pace.topic === topic)?.period ?? PERIODS[topic];
  }

  /** Forget what was shown; times from before mean nothing any more. */
  clear(): void {
    for (const ring of Object.values(this.rings)) ring.clear();
    this.debug.clear();
    this.events.clear();
    this.state = null;
    this.parameters = null;
    this.calibration = null;
    this.detection = null;
    this.detectionRate = null;
    this.#detected = [];
    this.picture = null;
    for (const name of WATCHED) this[name] = null;
    this.vision = null;
    this.mission = null;
  }

  /** Take in what of a block is later than `after`. Returns the time up to which its topic is known (s), if any. */
  take(block: Block, after = -Infinity): number | null {
    for (const ring of Object.values(this.rings)) {
      if (ring.topic.id !== block.topic) continue;
      ring.append(block.payload, after);
      this.#sampled ||= ring === this.rings.imu;
      return ring.newest;
    }
    if (block.topic === OTHER_TOPICS.picture) {
      const picture = readPicture(block);
      if (picture.time > after) this.picture = picture;
      return picture.time;
    }
    for (const name of WATCHED) {
      if (block.topic !== OTHER_TOPICS[name]) continue;
      const picture = readPicture(block);
      // One that was on its way when the last viewer left would be an old one for the next.
      if (this.#watching[name] > 0) this[name] = picture;
      return picture.time;
    }
    const documents = (readDocuments(block) as { time: number }[]).filter((document) => document.time > after);
    return this.takeDocuments(block.topic, documents);
  }

  /** Take in documents of one topic, in order of time. Returns the time of the last, if there is one. */
  takeDocuments(topic: number, documents: { time: number }[]): number | null {
    const last = documents.at(-1);
    if (last === undefined) return null;
    this.#keep(topic, documents, last);
    return last.time;
  }

  #keep(topic: number, documents: { time: number }[], last: { time: number }): void {
    if (topic === OTHER_TOPICS.state) this.state = last as State;
    else if (topic === OTHER_TOPICS.parameters) this.parameters = (last as Parameters).parameters;
    else if (topic === OTHER_TOPICS.calibration) this.calibration = last as CalibrationKept;
    else if (topic === OTHER_TOPICS.detection) this.#detect(documents, last as Detection);
    else if (topic === OTHER_TOPICS.vision) this.vision = last as VisionInForce;
    else if (topic === OTHER_TOPICS.mission) this.mission = last as Mission;
    else if (topic === OTHER_TOPICS.debug) this.debug.append(documents as DebugLine[]);
    else if (topic === OTHER_TOPICS.event || topic === OTHER_TOPICS.notice) {
      this.events.append(documents as RobotEvent[]);
    }
  }

  #detect(all: { time: number }[], last: Detection): void {
    this.detection = last;
    this.#detected = [...this.#detected, ...all.map(({ time }) => time)].slice(-RATE_OVER);
    const [first = last.time] = this.#detected;
    this.detectionRate = last.time > first ? (this.#detected.length - 1) / (last.time - first) : null;
  }

  /** Show at once what has become another, digits too. */
  refresh(): void {
    this.#tick += 1;
    this.#frame += 1;
  }

  /** Draw soon, and not more often than eyes can tell. */
  redraw(): void {
    if (this.#awaited) return;
    this.#awaited = true;
    const draw = (at: number) => {
      if (!this.#pace.isDue(at / 1000, FRAME, this.#sampled)) {
        requestAnimationFrame(draw);
        return;
      }
      this.#awaited = false;
      this.#sampled = false;
      this.#frame += 1;
    };
    requestAnimationFrame(draw);
  }
}

export const [useLive, provideLive] = createContext<Live>();
