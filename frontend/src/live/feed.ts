import type { Access } from '../access/access.svelte';
import { api } from '../api';
import { Control } from './control.svelte';
import { keeps } from '../drive/holds';
import { Pilot } from '../drive/pilot.svelte';
import { DEFINITIONS_HASH } from '../generated/topics';
import { nameClient } from '../http';
import { readBlocks, type Block } from './blocks';
import { SteadyClock } from './clock';
import { Live } from './live.svelte';
import { deliver, type Hello, type Listeners, type Messages } from './messages';
import { Past } from './past';
import { LiveSocket } from './socket';
import { Stop } from './stop.svelte';
import { Progress } from './store';

/** s by which the robot's clock may seem to jump before it is taken for another clock. */
const CLOCK_JUMP = 5;
/** s by which the robot's calendar may drift before the page follows it */
const DATE_JUMP = 0.5;
/** s that a page may miss; below FIRST_SECONDS (65 s, server/stream/hub.py), within which the server sends what was missed */
const AWAY = 50;

/** The robot as it is now: fills a `Live` from the live socket. */
/** Attempts to open the socket before its certificate is suspected: a server may just be starting */
const REFUSALS = 3;

export class LiveFeed {
  readonly live: Live;
  readonly pilot: Pilot;
  readonly #progress = new Progress();
  readonly #steady = new SteadyClock(() => performance.now() / 1000);
  readonly #socket: LiveSocket;
  readonly #control: Control;
  readonly #past: Past;
  /** that of the server which this page was loaded from */
  #pageVersion: string | null = null;
  #wasOpen = false;
  #refusals = 0;
  readonly #listeners: Listeners = {
    hello: (hello) => this.#greet(hello),
    pong: (pong) => this.#hearPong(pong),
    control: (state) => this.#control.hear(state),
    health: ({ parts }) => (this.live.parts = parts),
    session: ({ recording }) => (this.live.recording = recording),
    summary: ({ session }) => (this.live.summarised = session),
    scenario: (state) => (this.live.scenario = state),
    sweeps: ({ sweeps }) => (this.live.sweeps = sweeps),
    tuning: (state) => (this.live.tuning = state),
    comm_test: ({ active, cell }) => this.live.commTest.take(active, cell),
    alarms: ({ alarms }) => (this.live.serverAlarms = alarms),
    error: ({ text }) => (this.live.serverError = text),
  };

  /** @param access whoever uses this page; told where the server does not know them any more */
  constructor(
    url: string,
    private readonly access: Pick<Access, 'know' | 'check' | 'lab'>,
    private readonly encrypted = url.startsWith('wss:'),
  ) {
    this.#socket = new LiveSocket(url, {
      opened: () => this.#opened(),
      closed: (reason, refused) => this.#closed(reason, refused),
      text: (text) => deliver(text, this.#listeners),
      bytes: (buffer) => this.#take(buffer),
      roundTrip: (milliseconds) => (this.live.roundTrip = milliseconds),
    });
    const stop = new Stop(
      () => !access.lab && this.#socket.send({ op: 'stop' }),
      () => (access.lab ? this.#stopAll() : api.stop()),
    );
    this.#control = new Control(
      { take: api.takeControl, release: api.releaseControl, takeOver: api.takeControlOver },
      // A lab has no robot to be controlled.
      () => !document.hidden && !this.access.lab,
    );
    this.live = new Live(() => this.#steady.now(), stop, this.#control);
    this.pilot = new Pilot({
      say: (said) => this.#socket.send({ op: 'drive', ...said }),
      now: () => this.#steady.now(),
      lease: () => this.#lease(),
      keeps: (axis) => keeps(this.live.state, axis),
    });
    this.#past = new Past(this.live.rings, api.past, () => this.live.redraw());
    this.live.wantPast = this.#past.want;
    this.live.onWatch = () => this.#watch();
  }

  /** Open the socket and keep it open. Returns what ends it. */
  start(): () => void {
    this.#socket.start();
    const rest = this.live.beat();
    const land = this.pilot.start();
    const retry = () => this.#socket.retryNow();
    const wake = () => {
      if (!document.hidden) this.#socket.woke();
    };
    const { consider } = this.#control;
    window.addEventListener('online', retry);
    window.addEventListener('pageshow', wake);
    document.addEventListener('visibilitychange', wake);
    document.addEventListener('visibilitychange', consider);
    return () => {
      rest();
      land();
      window.removeEventListener('online', retry);
      window.removeEventListener('pageshow', wake);
      document.removeEventListener('visibilitychange', wake);
      document.removeEventListener('visibilitychange', consider);
      this.#socket.end();
      this.live.stop.end();
      nameClient(null);
    };
  }

  /** The lease to drive by; null where this page may not drive, or nobody looks at it. */
  #lease(): number | null {
    const { connection, state } = this.live;
    const drives = connection === 'open' && state?.mode === 'manual' && this.#control.mine;
    return drives && !document.hidden && document.hasFocus() ? (this.#control.now?.epoch ?? null) : null;
  }

  async #stopAll(): Promise<string | null> {
    const answer = await api.stopAll();
    if ('problem' in answer) return answer.problem;
    this.live.stopped = answer.value;
    return null;
  }

  #opened(): void {
    const { live } = this;
    live.connection = 'open';
    live.serverError = '';
    live.farewell = '';
    live.untrusted = false;
    this.#wasOpen = true;
    this.#progress.reconnect();
    live.commTest.reconnect();
    live.sweeps = [];
    live.gaps.restart();
    if (live.watched.length > 0) this.#watch();
  }

  #watch(): void {
    this.#socket.send({ op: 'watch', pictures: ['picture', ...this.live.watched] });
  }

  #closed(reason: string, refused: boolean): void {
    this.live.connection = 'lost';
    this.live.roundTrip = null;
    this.#control.leave();
    nameClient(null);
    if (reason !== '') this.live.farewell = reason;
    if (refused) void this.#ask(reason);
  }

  /** Ask by HTTP why the socket does not open. Where that works by TLS, the browser may distrust the certificate. */
  async #ask(reason: string): Promise<void> {
    this.#refusals += 1;
    const answers = await this.access.check(reason);
    const { live } = this;
    live.untrusted = answers && reason === '' && this.encrypted && !this.#wasOpen && this.#refusals >= REFUSALS && live.connection === 'lost';
  }

  #hearPong({ id, steady, utc }: Messages['pong']): void {
    this.#socket.answered(id);
    const { instant } = this.live;
    // Only where the robot's calendar was set: all times that the page shows are computed anew.
    if (instant === null || Math.abs(utc - steady - (instant.utc - instant.steady)) <= DATE_JUMP) return;
    this.live.instant = { steady, utc };
  }

  #greet(hello: Hello): void {
    const { live } = this;
    this.#pageVersion ??= hello.page_version;
    live.outdated = hello.definitions !== DEFINITIONS_HASH || hello.page_version !== this.#pageVersion;
    if (this.#steady.known && Math.abs(this.#steady.now() - hello.steady) > CLOCK_JUMP) {
      // Another clock speaks: the robot's computer was restarted, or this one slept. Times from before mean nothing.
      this.#steady.reset();
      this.#progress.forget();
      this.#past.forget();
      live.clear();
    }
    nameClient(hello.client_key);
    this.access.know(hello.you);
    this.#control.greet(hello.you);
    this.#steady.observe(hello.steady);
    live.hello = hello;
    live.instant = hello;
  }

  #take(buffer: ArrayBuffer): void {
    const { live } = this;
    // Rows of other definitions would be read as nonsense: wait for the reload instead.
    if (live.hello !== null && live.hello.definitions !== DEFINITIONS_HASH) return;
    for (const block of readBlocks(buffer)) {
      live.gaps.observe(block.topic, block.first, block.count);
      this.#takeBlock(block);
    }
    live.redraw();
  }

  #takeBlock(block: Block): void {
    const known = this.#progress.knownUntil(block.topic);
    this.#clearBeforeHole(block, known);
    const time = this.live.take(block, known);
    if (time === null) return;
    this.#steady.observe(time);
    this.#progress.reach(block.topic, time);
  }

  /**
   * Clears a topic's rows where those of a new connection do not join on to them, for one where this page slept: the
   * past as a whole has no hole.
   */
  #clearBeforeHole(block: Block, known: number): void {
    const ring = Object.values(this.live.rings).find(({ topic }) => topic.id === block.topic);
    if (ring?.newest !== known || block.payload.getFloat64(0, true) <= known) return;
    // A server that has just been started may have less than this page.
    if (this.#steady.now() - known <= AWAY) return;
    ring.clear();
    this.#past.forget();
  }
}
