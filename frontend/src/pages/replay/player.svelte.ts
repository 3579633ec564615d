import type { Answer, Stretch, Timeline } from '../../api';
import { Live } from '../../live/live.svelte';
import type { Stop } from '../../live/stop.svelte';
import { Reel } from './reel';

export const SPEEDS = [0.25, 0.5, 1, 2, 4, 8, 16] as const;
export type Speed = (typeof SPEEDS)[number];

/** s that a seek brings along, so that it comes soon */
const SEEK_AHEAD = 5;
/** s of playing that one later answer brings, and s of playing in store below which the next is fetched */
const WINDOW = 6;
const STORE_LEAST = 5;
/** s before a moment that a seek brings for charts; robot_runtime/contract/topics.py says of which topics */
const SEEK_BACK = 300;
/** s between two frames beyond which the page was asleep, and the replay with it */
const SLEPT = 0.25;
/** s: so near behind a marker, "previous" means the one before */
const NEAR = 1;

/** Where a replay gets its session from. */
export interface Source {
  timeline(): Promise<Answer<Timeline>>;
  /** from `start` up to `end` (s since the session's start), with what was before where a `history` (s) is given */
  blocks(start: number, end: number, history?: number): Promise<Answer<Stretch>>;
}

/** Plays a session: fills a `Live` of its own with what is due. Times are s since the session's start. */
export class Player {
  readonly live: Live;
  timeline = $state.raw<Timeline | null>(null);
  /** where the replay stands, or is on its way to */
  position = $state(0);
  playing = $state(false);
  speed = $state<Speed>(1);
  /** what is to be shown next is being fetched */
  waiting = $state(false);
  problem = $state('');
  /** samples of the stretch fetched last that could not be given */
  leftOut = $state(0);

  readonly #reel = new Reel();
  /** up to here everything was handed to `live` */
  #shown = 0;
  /** up to here everything was fetched */
  #fetched = 0;
  #seeking = false;
  #target: number | null = null;
  #filling = false;
  /** counts seeks, to tell answers that came too late */
  #turn = 0;
  #last = 0;
  #ended = false;

  /** @param clock this computer's steady clock, s */
  constructor(
    private readonly source: Source,
    stop: Stop,
    private readonly clock: () => number = () => performance.now() / 1000,
  ) {
    this.live = new Live(() => this.#zero + this.#shown, stop, null);
    this.live.connection = 'open';
  }

  get duration(): number {
    return this.timeline?.duration ?? 0;
  }

  /** Fetch what the session is about, and show the moment `at`. */
  async open(at: number): Promise<void> {
    this.position = at;
    this.problem = '';
    const answer = await this.source.timeline();
    if (this.#ended) return;
    if ('problem' in answer) {
      this.problem = answer.problem;
      return;
    }
    this.timeline = answer.value;
    this.live.instant = { steady: answer.value.started_steady, utc: Date.parse(answer.value.started) / 1000 };
    await this.seek(at);
  }

  /** Nothing is to come any more. */
  end(): void {
    this.#ended = true;
    this.playing = false;
  }

  play(): void {
    if (this.timeline === null) return;
    this.#last = this.clock();
    this.playing = true;
    if (this.position >= this.duration) void this.seek(0);
  }

  pause(): void {
    this.playing = false;
    if (!this.#seeking) this.waiting = false;
  }

  readonly toggle = (): void => {
    if (this.playing) this.pause();
    else this.play();
  };

  /** Go on after a problem. */
  readonly retry = (): void => {
    if (this.timeline === null) void this.open(this.position);
    else void this.seek(this.position, true);
  };

  skip(by: number): void {
    void this.seek(this.position + by);
  }

  /** Show another moment; `anew` even where it is in store. Resolves once it is shown or cannot be. */
  async seek(to: number, anew = false): Promise<void> {
    if (this.timeline === null) return;
    const target = Math.min(Math.max(to, 0), this.duration);
    this.position = target;
    this.problem = '';
    if (!this.#seeking && !anew && target >= this.#shown && target < this.#fetched) {
      this.#show(target);
      this.live.refresh();
      return;
    }
    this.#target = target;
    if (this.#seeking) return;
    this.#seeking = true;
    this.waiting = true;
    // Whoever drags the slider is faster than the answers: of the moments in between some are shown.
    while (this.#target !== null) {
      const next: number = this.#target;
      this.#target = null;
      await this.#jump(next);
    }
    this.#seeking = false;
    this.waiting = false;
    this.#last = this.clock();
  }

  /** Let the replay follow the clock; to be called with every frame. */
  advance(): void {
    const now = this.clock();
    const passed = Math.min(now - this.#last, SLEPT);
    this.#last = now;
    if (!this.playing || this.#seeking || this.timeline === null) return;
    let to = this.#shown + passed * this.speed;
    this.waiting = to > this.#fetched && this.#fetched < this.#limit;
    if (this.waiting) to = Math.max(this.#shown, this.#fetched);
    if (this.waiting && this.problem !== '') this.pause();
    if (to >= this.duration) {
      to = this.duration;
      this.playing = false;
    }
    this.position = to;
    this.#show(to);
    this.live.redraw();
    void this.#fill();
  }

  /** The marker before or after the present moment, if there is one. */
  neighbour(direction: -1 | 1): number | null {
    const times = this.timeline?.markers.map(({ time }) => time) ?? [];
    if (direction === 1) return times.find((time) => time > this.position + 0.01) ?? null;
    const near = this.playing ? NEAR : 0.01;
    return times.findLast((time) => time < this.position - near) ?? null;
  }

  /** A marker was made. */
  marked(marker: Timeline['markers'][number]): void {
    if (this.timeline === null) return;
    const markers = [...this.timeline.markers, marker].sort((one, other) => one.time - other.time);
    this.timeline = { ...this.timeline, markers };
  }

  get #zero(): number {
    return this.timeline?.started_steady ?? NaN;
  }

  /** What is to be fetched at most: the last sample may lie at the very end. */
  get #limit(): number {
    return this.duration + 1;
  }

  async #jump(to: number): Promise<void> {
    this.#turn += 1;
    const turn = this.#turn;
    const end = Math.min(to + SEEK_AHEAD, this.#limit);
    const answer = await this.source.blocks(to, end, SEEK_BACK);
    if (this.#ended || turn !== this.#turn) return;
    if ('problem' in answer) {
      this.problem = answer.problem;
      this.playing = false;
      return;
    }
    this.#reel.clear();
    this.live.clear();
    this.#reel.add(answer.value.blocks);
    this.leftOut = answer.value.leftOut;
    this.#fetched = end;
    this.#show(to);
    this.live.refresh();
  }

  async #fill(): Promise<void> {
    const speed = Math.max(1, this.speed);
    const enough = this.#fetched - this.#shown > STORE_LEAST * speed || this.#fetched >= this.#limit;
    if (this.#filling || enough || this.problem !== '') return;
    this.#filling = true;
    const turn = this.#turn;
    const end = Math.min(this.#fetched + WINDOW * speed, this.#limit);
    const answer = await this.source.blocks(this.#fetched, end);
    this.#filling = false;
    if (this.#ended || turn !== this.#turn) return;
    if ('problem' in answer) {
      this.problem = answer.problem;
      return;
    }
    this.#reel.add(answer.value.blocks);
    this.leftOut = answer.value.leftOut;
    this.#fetched = end;
  }

  #show(to: number): void {
    this.#shown = to;
    this.#reel.unroll(this.#zero + (to < this.duration ? to : this.#limit), this.live);
  }
}
