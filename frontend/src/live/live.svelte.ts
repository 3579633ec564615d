import { createContext } from 'svelte';
import { DOCUMENT_TOPICS, PICTURE_TOPICS, type Alarm, type DebugLine, type Detection, type Documents, type RobotEvent, type Rows, type State } from '../generated/topics';
import { readDocuments, readPicture, type Block } from './blocks';
import { calendar, type Instant } from './clock';
import { keepDetections } from './found';
import { groupAlarms, membersOf, type AlarmGroup } from './alarms';
import type { Control } from './control.svelte';
import { CommTestWatch } from './comm_test.svelte';
import { freshness, worst, type Freshness } from './freshness';
import { Lines } from './lines.svelte';
import type { FilmDescription, PartHealth, ScenarioState, Session, StoppedRobot, SweepSummary, TuningState } from '../api';
import type { Hello } from './messages';
import { createNewest } from './newest.svelte';
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

export interface Picture {
  readonly time: number;
  readonly jpeg: Blob;
}

type PictureTopic = keyof typeof PICTURE_TOPICS;
/** pictures that are made only while somebody asked for them with `watch` */
type WatchedPicture = Exclude<PictureTopic, 'picture' | 'thumbnail' | 'snapshot'>;

const isUnasked = (topic: PictureTopic): topic is Exclude<PictureTopic, WatchedPicture> => topic === 'picture' || topic === 'thumbnail' || topic === 'snapshot';

const namesOf = <Name extends string>(topics: Record<Name, number>) => Object.keys(topics) as Name[];
const byNumber = <Name extends string>(topics: Record<Name, number>) => new Map(namesOf(topics).map((name) => [topics[name], name]));
const DOCUMENT_NAMES = byNumber(DOCUMENT_TOPICS);
const PICTURE_NAMES = byNumber(PICTURE_TOPICS);

/** A film, and where its replay stands. */
export interface ReplayedFilm {
  readonly session: number;
  readonly film: FilmDescription;
  /** s since the session's start */
  readonly following: { readonly position: number; readonly playing: boolean; readonly speed: number };
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
  parts = $state.raw<readonly PartHealth[]>([]);
  recording = $state.raw<Session | null>(null);
  /** the session whose summary was made last; null before the server has made one */
  summarised = $state<number | null>(null);
  /** the newest document of each topic */
  /** those that may be of the picture that is shown, in order of time; of the robot itself the newest alone */
  detections = $state.raw<readonly Documents['detection'][]>([]);
  readonly documents = createNewest<Documents>(namesOf(DOCUMENT_TOPICS));
  /** the newest picture of each topic: of the camera, and of what somebody asked for with `watch` */
  readonly pictures = createNewest<Record<PictureTopic, Picture>>(namesOf(PICTURE_TOPICS));
  /** the film of the session that is replayed, where there is one */
  film = $state.raw<ReplayedFilm | null>(null);
  serverError = $state('');
  /** alarms of the server, which sees what the runtime cannot: that it is silent, for one */
  serverAlarms = $state.raw<readonly Alarm[]>([]);
  readonly rings = createRings();
  readonly debug = new Lines<DebugLine>(CONSOLE_LINES);
  readonly events = new Lines<RobotEvent>(EVENT_LINES, (one, other) => one.time - other.time);
  readonly #detections = new Lines<Detection>(RATE_OVER);
  /** where every document counts, not the newest alone */
  readonly #lists: { readonly [Name in keyof Documents]?: Pick<Lines<Documents[Name]>, 'append' | 'clear'> } = {
    debug: this.debug,
    event: this.events,
    notice: this.events,
    detection: this.#detections,
  };
  readonly gaps = new Gaps();
  readonly commTest = new CommTestWatch();
  /** null until the server has said whether a scenario runs */
  scenario = $state.raw<ScenarioState | null>(null);
  /** those that wait or run, and the one that ended last */
  sweeps = $state.raw<readonly SweepSummary[]>([]);
  /** null until the server has said whether an experiment runs */
  tuning = $state.raw<TuningState | null>(null);

  /** counts frames in which something new is to be drawn, and the slower beat at which digits are read */
  #frame = $state(0);
  #tick = $state(0);
  readonly #pace = new Pace();
  #awaited = false;
  /** whether the board's samples came since the last frame: it is drawn with them */
  #sampled = false;
  /** what the robots of a lab have answered to the last STOP */
  stopped = $state.raw<readonly StoppedRobot[]>([]);
  /** the pictures that are looked at, each as often as somebody does */
  readonly #watching: WatchedPicture[] = [];
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

  /** whether a simulator on this computer gives the robot its water */
  get simulated(): boolean {
    return this.parts.some(({ name, state }) => name === 'simulator' && state !== 'absent');
  }

  get state(): State | null {
    return this.documents.state.value;
  }

  /** Hz, as detections really come; null while there are fewer than two */
  get detectionRate(): number | null {
    const times = this.#detections.entries.map(({ time }) => time);
    const span = (times.at(-1) ?? 0) - (times[0] ?? 0);
    return span > 0 ? (times.length - 1) / span : null;
  }

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
    this.#watching.push(topic);
    if (this.#watching.indexOf(topic) === this.#watching.length - 1) this.onWatch?.();
    return () => {
      this.#watching.splice(this.#watching.indexOf(topic), 1);
      if (this.#watching.includes(topic)) return;
      this.pictures[topic].value = null;
      this.onWatch?.();
    };
  }

  /** the pictures that somebody looks at beside the camera's */
  get watched(): WatchedPicture[] {
    return this.#watching.filter((topic, at) => this.#watching.indexOf(topic) === at);
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

  /** Freshness of the newest picture of the camera: of its stream, or of those that are searched where there is none. */
  get pictureFreshness(): Freshness {
    return this.freshness(this.pictures.camera.value ? 'camera' : 'picture');
  }

  /** why the camera gives no picture, as a sentence; empty where it does, or where that is not known */
  get cameraFailure(): string {
    const camera = this.parts.find(({ name }) => name === 'camera');
    return camera?.state === 'absent' ? camera.text : '';
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
    if (topic in this.rings) return this.rings[topic as keyof Rows].newest;
    const { value } = topic in this.pictures ? this.pictures[topic as PictureTopic] : this.documents[topic as keyof Documents];
    return value?.time ?? null;
  }

  /** s between two samples of a topic as things are */
  period(topic: Timed): number {
    if (topic === 'picture' && this.replayed) return THUMBNAIL_PERIOD;
    if (topic === 'detection' || topic === 'picture' || topic === 'mask') return 1 / (this.state?.vision_rate ?? 1);
    if (topic === 'camera') return 1 / (this.state?.stream_rate ?? 1);
    if (topic === 'observer') return OBSERVER_PERIOD;
    if (topic === 'control' || topic === 'turning' || topic === 'track' || topic === 'navigation') return 1 / (this.state?.control_rate ?? 10);
    return this.state?.paces.find((pace) => pace.topic === topic)?.period ?? PERIODS[topic];
  }

  /** Forget what was shown; times from before mean nothing any more. */
  clear(): void {
    for (const ring of Object.values(this.rings)) ring.clear();
    for (const list of Object.values(this.#lists)) list.clear();
    for (const newest of [...Object.values(this.documents), ...Object.values(this.pictures)]) newest.value = null;
    this.detections = [];
  }

  /** Take in what of a block is later than `after`. Returns the time up to which its topic is known (s), if any. */
  take(block: Block, after = -Infinity): number | null {
    for (const ring of Object.values(this.rings)) {
      if (ring.topic.id !== block.topic) continue;
      ring.append(block.payload, after);
      this.#sampled ||= ring === this.rings.imu;
      return ring.newest;
    }
    const picture = PICTURE_NAMES.get(block.topic);
    if (picture !== undefined) return this.#takePicture(picture, readPicture(block));
    const documents = (readDocuments(block) as { time: number }[]).filter((document) => document.time > after);
    return this.takeDocuments(block.topic, documents);
  }

  #takePicture(topic: PictureTopic, picture: Picture): number {
    // One that was on its way when the last viewer left would be an old one for the next.
    if (isUnasked(topic) || this.#watching.includes(topic)) this.pictures[topic].value = picture;
    return picture.time;
  }

  /** Take in documents of one topic, in order of time. Returns the time of the last, if there is one. */
  takeDocuments(topic: number, documents: { time: number }[]): number | null {
    const [name, last] = [DOCUMENT_NAMES.get(topic), documents.at(-1)];
    if (last === undefined) return null;
    if (name !== undefined) this.#keep(name, documents as Documents[typeof name][]);
    return last.time;
  }

  #keep<Name extends keyof Documents>(name: Name, documents: Documents[Name][]): void {
    this.documents[name].value = documents.at(-1) ?? null;
    if (name === 'detection') this.#keepDetections(documents as Documents['detection'][]);
    this.#lists[name]?.append(documents);
  }

  #keepDetections(newer: Documents['detection'][]): void {
    this.detections = this.replayed ? keepDetections(this.detections, newer) : newer.slice(-1);
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
