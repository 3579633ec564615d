import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { Answer, Stretch, Timeline } from '../src/api';
import { DOCUMENT_TOPICS } from '../src/generated/topics';
import { Stop } from '../src/live/stop.svelte';
import { Player, type Source } from '../src/pages/replay/player.svelte';
import { ticks } from '../src/pages/replay/ticks';
import { depthBlock, documentBlock, join } from './bytes';

const ZERO = 1000;

/** A session of depths that tell their own time: 0.02 m deeper with every 20 ms, and a line a second. */
class Session implements Source {
  asked: { start: number; end: number; history: number | undefined }[] = [];
  failing = '';
  /** answers wait for `release` */
  held: (() => void)[] | null = null;
  made: Partial<Timeline> = {};
  /** the server does not answer */
  away = false;
  /** s from here on, a second's samples are damaged */
  damagedFrom = NaN;
  /** samples at the very end, of which the duration tells */
  atEnd = 0;

  constructor(readonly duration = 100) {}

  timeline(): Promise<Answer<Timeline>> {
    if (this.away) return Promise.resolve({ problem: 'The server does not answer.' });
    return Promise.resolve({
      value: {
        name: 'a dive',
        state: 'complete',
        started: '2026-11-21T10:00:00Z',
        started_steady: ZERO,
        duration: this.duration,
        events: [],
        markers: [],
        holes: [],
        filmed: false,
        ...this.made,
      },
    });
  }

  async blocks(start: number, end: number, history?: number): Promise<Answer<Stretch>> {
    this.asked.push({ start, end, history });
    const { held } = this;
    if (held !== null) await new Promise<void>((resolve) => held.push(resolve));
    if (this.failing !== '') return { problem: this.failing };
    const from = Math.max(0, start - (history ?? 0));
    const first = Math.ceil(from * 50);
    const last = Math.min(Math.ceil(end * 50), this.duration * 50 + this.atEnd);
    const depths = Array.from({ length: Math.max(0, last - first) }, (_, index) => (first + index) / 50);
    const lines = [];
    for (let second = Math.ceil(from); second < Math.min(end, this.duration); second += 1) {
      lines.push({ time: ZERO + second, level: 1, text: `line ${second}` });
    }
    const state = history === undefined ? [] : [documentBlock(DOCUMENT_TOPICS.state, [{ time: ZERO + Math.max(0, start - 1), paces: [] }])];
    return {
      value: {
        leftOut: this.damagedFrom >= from && this.damagedFrom < end ? 50 : 0,
        blocks: join(...state, depthBlock(ZERO + first / 50, depths), documentBlock(DOCUMENT_TOPICS.debug, lines)).buffer,
      },
    };
  }

  release(): void {
    const all = this.held ?? [];
    this.held = null;
    for (const one of all) one();
  }
}

let now = 0;
let session: Session;
let player: Player;

/** Let time pass, frame by frame, and answers come. */
async function pass(seconds: number): Promise<void> {
  for (let frame = 0; frame < Math.round(seconds * 20); frame += 1) {
    now += 0.05;
    player.advance();
    await settle();
  }
}

async function settle(): Promise<void> {
  for (let turn = 0; turn < 6; turn += 1) await Promise.resolve();
}

function make(made: Session): void {
  session = made;
  player = new Player(session, new Stop(() => true), () => now);
}

const newest = () => (player.live.rings.depth.newest ?? NaN) - ZERO;
const lines = () => player.live.debug.entries.map(({ text }) => text);

beforeEach(() => {
  now = 50;
  vi.stubGlobal('requestAnimationFrame', () => 0);
  make(new Session());
});

afterEach(() => vi.unstubAllGlobals());

describe('Player', () => {
  it('shows the moment that it is opened at, and nothing later', async () => {
    await player.open(30);
    expect(player.position).toBe(30);
    expect(newest()).toBeCloseTo(29.98, 6);
    expect(lines().at(-1)).toBe('line 29');
    expect(player.live.state?.time).toBe(ZERO + 29);
    expect(player.live.now).toBe(ZERO + 30);
    expect(player.live.date(ZERO + 30).toISOString()).toBe('2026-11-21T10:00:30.000Z');
    expect(player.live.replayed).toBe(true);
    await pass(1);
    expect(player.position).toBe(30);
  });

  it('opens at the same moment where it is tried again', async () => {
    session.away = true;
    await player.open(30);
    expect(player.problem).toBe('The server does not answer.');
    session.away = false;
    player.retry();
    await settle();
    expect(player.position).toBe(30);
    expect(newest()).toBeCloseTo(29.98, 6);
  });

  it('names damaged samples only near them', async () => {
    session.damagedFrom = 2;
    await player.open(0);
    expect(player.leftOut).toBe(50);
    player.play();
    await pass(20);
    expect(player.leftOut).toBe(0);
  });

  it('shows the last sample at the end', async () => {
    make(new Session(8));
    session.atEnd = 1;
    await player.open(6);
    player.play();
    await pass(5);
    expect(newest()).toBeCloseTo(8, 6);
  });

  it('plays at the pace of the clock, every sample once', async () => {
    await player.open(10);
    player.play();
    await pass(20);
    expect(player.position).toBeCloseTo(30, 6);
    expect(newest()).toBeCloseTo(29.98, 1);
    const { depth } = player.live.rings;
    const times = Array.from({ length: depth.length }, (_, order) => depth.time[depth.place(order)] ?? NaN);
    expect(new Set(times).size).toBe(times.length);
    expect([...times].sort((a, b) => a - b)).toEqual(times);
    expect(times.length).toBe(Math.round((newest() + 0.02) * 50));
    expect(lines()).toEqual(Array.from({ length: 30 }, (_, second) => `line ${second}`));
  });

  it('fetches windows that join on to each other, before they are due', async () => {
    await player.open(0);
    player.play();
    await pass(30);
    const later = session.asked.slice(1);
    expect(later.length).toBeGreaterThan(2);
    later.forEach(({ start, history }, index) => {
      expect(start).toBe(session.asked[index]?.end);
      expect(history).toBeUndefined();
    });
    expect(player.waiting).toBe(false);
  });

  it.each([
    [0.25, 5],
    [2, 40],
    [16, 96],
  ] as const)('plays %s times as fast', async (speed, passed) => {
    await player.open(0);
    player.speed = speed;
    player.play();
    await pass(speed === 16 ? 6 : 20);
    expect(player.position).toBeCloseTo(passed, 6);
    expect(newest()).toBeCloseTo(passed - 0.02, 0);
  });

  it('stands still while it is paused, and goes on from there', async () => {
    await player.open(10);
    player.play();
    await pass(2);
    player.toggle();
    const age = player.live.freshness('depth').age;
    await pass(30);
    expect(player.position).toBeCloseTo(12, 6);
    expect(player.live.freshness('depth')).toEqual({ state: 'fresh', age });
    player.toggle();
    await pass(1);
    expect(player.position).toBeCloseTo(13, 6);
  });

  it('goes back by forgetting what came later', async () => {
    await player.open(50);
    await player.seek(20);
    expect(newest()).toBeCloseTo(19.98, 6);
    expect(lines().at(-1)).toBe('line 19');
    expect(player.live.now).toBe(ZERO + 20);
  });

  it('goes on a little without asking, as it is in store', async () => {
    await player.open(50);
    await player.seek(53);
    expect(session.asked).toHaveLength(1);
    expect(newest()).toBeCloseTo(52.98, 6);
    await player.seek(80);
    expect(session.asked).toHaveLength(2);
    expect(newest()).toBeCloseTo(79.98, 6);
  });

  it('keeps to the session when it is sent beyond it', async () => {
    await player.open(-5);
    expect(player.position).toBe(0);
    await player.seek(1e6);
    expect(player.position).toBe(100);
  });

  it('shows the last moment asked for, however many were asked for meanwhile', async () => {
    await player.open(10);
    session.held = [];
    const first = player.seek(40);
    void player.seek(50);
    void player.seek(60);
    expect(player.position).toBe(60);
    expect(player.waiting).toBe(true);
    expect(newest()).toBeCloseTo(9.98, 6);
    session.release();
    await first;
    expect(newest()).toBeCloseTo(59.98, 6);
    expect(session.asked.map(({ start }) => start)).toEqual([10, 40, 60]);
    expect(player.waiting).toBe(false);
  });

  it('takes no answer that came too late for where it is now', async () => {
    await player.open(0);
    player.play();
    session.held = [];
    await pass(2);
    const { held } = session;
    session.held = null;
    await player.seek(60);
    for (const one of held) one();
    await settle();
    expect(newest()).toBeCloseTo(59.98, 6);
    await pass(10);
    expect(newest()).toBeCloseTo(69.98, 1);
  });

  it('waits for what is slow to come, and then goes on', async () => {
    await player.open(0);
    player.play();
    session.held = [];
    await pass(20);
    expect(player.waiting).toBe(true);
    expect(player.position).toBe(5);
    expect(player.playing).toBe(true);
    session.release();
    await settle();
    await pass(3);
    expect(player.waiting).toBe(false);
    expect(player.position).toBeCloseTo(8, 1);
  });

  it('says why it cannot go on, and tries again when told to', async () => {
    await player.open(0);
    session.failing = 'The server does not answer.';
    player.play();
    await pass(10);
    expect(player.problem).toBe('The server does not answer.');
    expect(player.playing).toBe(false);
    expect(player.position).toBe(5);
    session.failing = '';
    player.retry();
    await settle();
    expect(player.problem).toBe('');
    player.play();
    await pass(10);
    expect(player.position).toBeCloseTo(15, 6);
  });

  it('pauses at the end, and begins again from there', async () => {
    make(new Session(8));
    await player.open(6);
    player.play();
    await pass(5);
    expect(player.playing).toBe(false);
    expect(player.position).toBe(8);
    expect(newest()).toBeCloseTo(7.98, 6);
    player.play();
    await settle();
    await pass(1);
    expect(player.position).toBeCloseTo(1, 1);
  });

  it('sleeps when the page sleeps', async () => {
    await player.open(0);
    player.play();
    now += 600;
    player.advance();
    expect(player.position).toBeLessThan(1);
  });

  it('goes from marker to marker', async () => {
    const at = (time: number) => ({ id: time, time, text: '', name: '', made: '2026-11-21T10:00:00Z' });
    session.made = { markers: [at(10), at(20)] };
    await player.open(15);
    player.marked(at(12));
    expect(player.neighbour(-1)).toBe(12);
    expect(player.neighbour(1)).toBe(20);
    await player.seek(20);
    expect(player.neighbour(1)).toBeNull();
    expect(player.neighbour(-1)).toBe(12);
  });
});

describe('ticks', () => {
  it('of events on one place the gravest stands', () => {
    const event = (time: number, severity: 'info' | 'caution' | 'alarm') => ({ time, severity, kind: '', text: '' });
    const found = ticks([event(1, 'info'), event(1.1, 'alarm'), event(1.2, 'caution'), event(500, 'info')], 1000);
    expect(found.map(({ time }) => time)).toEqual([1.1, 500]);
  });
});
