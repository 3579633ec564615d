import { createContext } from 'svelte';
import { SvelteMap } from 'svelte/reactivity';
import {
  DEFINITIONS_HASH,
  OTHER_TOPICS,
  type DebugLine,
  type Detection,
  type RobotEvent,
  type Rows,
  type State,
} from '../generated/topics';
import { readBlocks, readDocuments, readPicture, type Block } from './blocks';
import { calendar, SteadyClock } from './clock';
import { CommTestWatch } from './comm_test.svelte';
import { freshness, worst, type Freshness } from './freshness';
import { Lines } from './lines.svelte';
import type { Part, ScenarioState, Session } from '../api';
import { readMessage, type Hello } from './messages';
import { PERIODS, type Timed } from './periods';
import { LiveSocket } from './socket';
import { Stop } from './stop.svelte';
import { createRings, Gaps, Progress } from './store';

const FRAME_LEAST = 30;
const TICK_EVERY = 125;
const CONSOLE_LINES = 2000;
const EVENT_LINES = 500;
/** how many detections a rate is counted over */
const RATE_OVER = 12;
/** s by which the robot's clock may seem to jump before it is taken for another clock. */
const CLOCK_JUMP = 5;

export interface Picture {
  readonly time: number;
  readonly jpeg: Blob;
}

/** Everything the page knows of the robot, as it comes through the live socket. */
export class Live {
  connection = $state<'connecting' | 'open' | 'lost'>('connecting');
  /** why the server ended the connection, where it said so */
  farewell = $state('');
  /** ms to the server and back; null while unknown */
  roundTrip = $state<number | null>(null);
  hello = $state.raw<Hello | null>(null);
  outdated = $state(false);
  parts = $state.raw<readonly Part[]>([]);
  recording = $state.raw<Session | null>(null);
  state = $state.raw<State | null>(null);
  detection = $state.raw<Detection | null>(null);
  /** Hz, as detections really come; null while there are fewer than two */
  detectionRate = $state<number | null>(null);
  picture = $state.raw<Picture | null>(null);
  /** what a bystander in the simulated water sees; comes only while somebody asked for it with `observe` */
  observer = $state.raw<Picture | null>(null);
  serverError = $state('');
  readonly rings = createRings();
  readonly debug = new Lines<DebugLine>(CONSOLE_LINES);
  readonly events = new Lines<RobotEvent>(EVENT_LINES);
  /** per topic, how many samples the server could not send to this page */
  readonly dropped = new SvelteMap<string, number>();
  readonly gaps = new Gaps();
  readonly stop: Stop;
  readonly commTest = new CommTestWatch();
  /** null until the server has said whether a scenario runs */
  scenario = $state.raw<ScenarioState | null>(null);

  /** counts frames in which something new is to be drawn, and the slower beat at which digits are read */
  #detected: number[] = [];
  #frame = $state(0);
  #tick = $state(0);
  #drawn = 0;
  #awaited = false;
  #observing = 0;
  readonly #progress = new Progress();
  readonly #steady = new SteadyClock(() => performance.now() / 1000);
  readonly #socket: LiveSocket;

  constructor(url: string) {
    this.#socket = new LiveSocket(url, {
      opened: () => this.#opened(),
      closed: (reason) => this.#closed(reason),
      text: (text) => this.#read(text),
      bytes: (buffer) => this.#take(buffer),
      roundTrip: (milliseconds) => (this.roundTrip = milliseconds),
    });
    this.stop = new Stop(() => this.#socket.send({ op: 'stop' }));
  }

  /** Open the socket and keep it open. Returns what ends it. */
  start(): () => void {
    this.#socket.start();
    const beat = setInterval(() => (this.#tick += 1), TICK_EVERY);
    const wake = () => this.#socket.retryNow();
    window.addEventListener('online', wake);
    return () => {
      clearInterval(beat);
      window.removeEventListener('online', wake);
      this.#socket.end();
    };
  }

  /** Have the bystander's pictures sent. Returns what ends that. */
  observe(): () => void {
    this.#observing += 1;
    if (this.#observing === 1) this.#watch();
    return () => {
      this.#observing -= 1;
      if (this.#observing > 0) return;
      this.observer = null;
      this.#watch();
    };
  }

  #watch(): void {
    this.#socket.send({ op: 'watch', pictures: this.#observing > 0 ? ['picture', 'observer'] : ['picture'] });
  }

  /** The robot's steady clock, s; NaN while unknown. Whoever reads it in an effect runs again with every tick. */
  get now(): number {
    void this.#tick;
    return this.#steady.now();
  }

  /** As `now`, for what is drawn with every frame. */
  get frameNow(): number {
    void this.#frame;
    return this.#steady.now();
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
    return worst(topics.map((topic) => freshness(this.#newest(topic), now, this.#period(topic))));
  }

  /** The instant of a steady time on this computer's calendar. */
  date(steady: number): Date {
    return calendar(steady, this.hello);
  }

  #newest(topic: Timed): number | null {
    if (topic === 'state') return this.state?.time ?? null;
    if (topic === 'detection') return this.detection?.time ?? null;
    if (topic === 'picture') return this.picture?.time ?? null;
    if (topic === 'observer') return this.observer?.time ?? null;
    return this.rings[topic].newest;
  }

  #period(topic: Timed): number {
    if (topic === 'detection' || topic === 'picture') return 1 / (this.state?.vision_rate ?? 1);
    if (topic === 'observer') return PERIODS.truth;
    if (topic === 'control' || topic === 'navigation') return 1 / (this.state?.control_rate ?? 10);
    return this.state?.paces.find((pace) => pace.topic === topic)?.period ?? PERIODS[topic];
  }

  #opened(): void {
    this.connection = 'open';
    this.serverError = '';
    this.farewell = '';
    this.#progress.reconnect();
    this.commTest.reconnect();
    this.gaps.restart();
    if (this.#observing > 0) this.#watch();
  }

  #closed(reason: string): void {
    this.connection = 'lost';
    this.roundTrip = null;
    if (reason !== '') this.farewell = reason;
  }

  #read(text: string): void {
    const message = readMessage(text);
    if (message === null) return;
    if (message.op === 'hello') this.#greet(message);
    else if (message.op === 'health') this.parts = message.parts;
    else if (message.op === 'session') this.recording = message.recording;
    else if (message.op === 'scenario') this.scenario = message;
    else if (message.op === 'comm_test') this.commTest.take(message.active, message.cell);
    else if (message.op === 'error') this.serverError = message.text;
    else if (message.op === 'pong') this.#socket.answered(message.id);
    else this.dropped.set(message.topic, (this.dropped.get(message.topic) ?? 0) + message.count);
  }

  #greet(hello: Hello): void {
    const before = this.hello;
    this.outdated =
      hello.definitions !== DEFINITIONS_HASH || (before !== null && before.page_version !== hello.page_version);
    if (this.#steady.known && Math.abs(this.#steady.now() - hello.steady) > CLOCK_JUMP) this.#forget();
    this.#steady.observe(hello.steady);
    this.hello = hello;
  }

  /** The robot's computer was restarted: times from before mean nothing on its new clock. */
  #forget(): void {
    this.#steady.reset();
    this.#progress.forget();
    for (const ring of Object.values(this.rings)) ring.clear();
    this.debug.clear();
    this.events.clear();
    this.state = null;
    this.detection = null;
    this.picture = null;
    this.observer = null;
  }

  #take(buffer: ArrayBuffer): void {
    // Rows of other definitions would be read as nonsense: wait for the reload instead.
    if (this.hello !== null && this.hello.definitions !== DEFINITIONS_HASH) return;
    for (const block of readBlocks(buffer)) {
      this.gaps.observe(block.topic, block.first, block.count);
      this.#takeBlock(block);
    }
    this.#redraw();
  }

  #takeBlock(block: Block): void {
    const after = this.#progress.knownUntil(block.topic);
    for (const ring of Object.values(this.rings)) {
      if (ring.topic.id !== block.topic) continue;
      ring.append(block.payload, after);
      if (ring.newest !== null) this.#arrived(block.topic, ring.newest);
      return;
    }
    if (block.topic === OTHER_TOPICS.picture) {
      const picture = readPicture(block);
      if (picture.time > after) this.picture = picture;
      this.#arrived(block.topic, picture.time);
      return;
    }
    if (block.topic === OTHER_TOPICS.observer) {
      this.observer = readPicture(block);
      return;
    }
    const documents = (readDocuments(block) as { time: number }[]).filter((document) => document.time > after);
    const last = documents.at(-1);
    if (last === undefined) return;
    this.#arrived(block.topic, last.time);
    this.#keep(block.topic, documents, last);
  }

  #keep(topic: number, documents: { time: number }[], last: { time: number }): void {
    if (topic === OTHER_TOPICS.state) this.state = last as State;
    else if (topic === OTHER_TOPICS.detection) this.#detect(documents, last as Detection);
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

  #arrived(topic: number, time: number): void {
    this.#steady.observe(time);
    this.#progress.reach(topic, time);
  }

  #redraw(): void {
    if (this.#awaited) return;
    this.#awaited = true;
    const draw = (at: number) => {
      if (at - this.#drawn < FRAME_LEAST) {
        requestAnimationFrame(draw);
        return;
      }
      this.#drawn = at;
      this.#awaited = false;
      this.#frame += 1;
    };
    requestAnimationFrame(draw);
  }
}

export const [useLive, provideLive] = createContext<Live>();
