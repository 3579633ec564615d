import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { DEFINITIONS_HASH, DOCUMENT_TOPICS, PICTURE_TOPICS } from '../src/generated/topics';
import { LiveFeed } from '../src/live/feed';
import type { Live } from '../src/live/live.svelte';
import { blockBytes, depthBlock, documentBlock, join } from './bytes';

/** Stands in for the browser's WebSocket; the test plays the server. */
class ServerEnd {
  static readonly OPEN = 1;
  static opened: ServerEnd[] = [];
  readyState = 0;
  onopen: (() => void) | null = null;
  onmessage: ((event: { data: unknown }) => void) | null = null;
  onclose: ((event: { reason: string; code: number }) => void) | null = null;
  sent: string[] = [];

  constructor() {
    ServerEnd.opened.push(this);
  }

  send(text: string) {
    this.sent.push(text);
  }

  close(reason = '', code = 1006) {
    this.readyState = 3;
    this.onclose?.({ reason, code });
  }

  greet(hello: object = {}) {
    this.readyState = ServerEnd.OPEN;
    this.onopen?.();
    this.tell({ op: 'hello', definitions: DEFINITIONS_HASH, robot: 't', steady: 100, utc: 1e9, page_version: 'a', features: [], you: YOU, client_key: 'key', ...hello });
  }

  tell(message: object) {
    this.onmessage?.({ data: JSON.stringify(message) });
  }

  give(...blocks: Uint8Array[]) {
    this.onmessage?.({ data: join(...blocks).buffer });
  }
}

const YOU = { name: 'Firefox on Linux', role: 'operator', client: 7 };
const access = { know: vi.fn(), check: vi.fn(() => Promise.resolve(true)), lab: false };
const server = () => ServerEnd.opened.at(-1) ?? new ServerEnd();
let live: Live;
let end: () => void;

beforeEach(() => {
  vi.useFakeTimers();
  ServerEnd.opened = [];
  vi.stubGlobal('WebSocket', ServerEnd);
  vi.stubGlobal('window', new EventTarget());
  vi.stubGlobal('document', Object.assign(new EventTarget(), { hidden: false, hasFocus: () => true }));
  vi.stubGlobal('requestAnimationFrame', () => 0);
  access.know.mockClear();
  access.check.mockClear();
  const feed = new LiveFeed('ws://robot/api/live', access);
  live = feed.live;
  end = feed.start();
});

afterEach(() => {
  end();
  vi.restoreAllMocks();
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const depths = () => Array.from({ length: live.rings.depth.length }, (_, order) => live.rings.depth.column('depth')[order]);

describe('Live', () => {
  it.each([
    ['wss://robot/api/live', true, true],
    ['ws://robot/api/live', true, false],
    ['wss://robot/api/live', false, false],
  ])('suspects the certificate of %s where HTTP answers (%s)', async (url, answers, suspected) => {
    end();
    const feed = new LiveFeed(url, { ...access, check: vi.fn(() => Promise.resolve(answers)) });
    ({ live } = feed);
    end = feed.start();
    for (let refused = 0; refused < 3; refused += 1) {
      expect(live.untrusted).toBe(false);
      server().close();
      await vi.advanceTimersByTimeAsync(3000);
    }
    expect(live.untrusted).toBe(suspected);
    server().greet();
    expect(live.untrusted).toBe(false);
    server().close();
    await vi.advanceTimersByTimeAsync(30_000);
    server().close();
    await vi.advanceTimersByTimeAsync(30_000);
    expect(live.untrusted).toBe(false);
  });

  it('takes in rows and documents', () => {
    server().greet();
    server().give(depthBlock(99, [0.1, 0.2]), documentBlock(DOCUMENT_TOPICS.debug, [{ time: 99, level: 1, text: 'hello' }]));
    expect(live.rings.depth.latest()?.depth).toBeCloseTo(0.2, 6);
    expect(live.debug.entries.map(({ text }) => text)).toEqual(['hello']);
  });

  it('has the newest calibration, until the robot’s clock is another', () => {
    server().greet();
    server().give(documentBlock(DOCUMENT_TOPICS.calibration, [{ time: 98, values: null, missing: ['b'] }, { time: 99, values: null, missing: [] }]));
    expect(live.documents.calibration.value?.missing).toEqual([]);
    server().greet({ steady: 5 });
    expect(live.documents.calibration.value).toBeNull();
  });

  it('counts time by the robot’s clock, whatever this computer’s calendar says', () => {
    server().greet();
    vi.setSystemTime(new Date('2031-01-01T00:00:00Z'));
    const recently = new Date((1e9 - 30) * 1000).toISOString();
    expect(live.since(recently)).toBeCloseTo(30, 3);
    vi.advanceTimersByTime(5000);
    expect(live.since(recently)).toBeCloseTo(35, 3);
  });

  it('follows the robot’s calendar where that is set', () => {
    server().greet();
    server().tell({ op: 'pong', id: 1, steady: 110, utc: 1e9 + 10.1 });
    expect(live.date(100).getTime()).toBe(1e12);
    server().tell({ op: 'pong', id: 2, steady: 111, utc: 1e9 + 11 + 10_800 });
    expect(live.date(100).getTime()).toBe(1e12 + 10_800_000);
  });

  it('opens again for ever, and takes a replay only once', () => {
    server().greet();
    const line = (time: number, text: string) => ({ time, level: 1, text });
    server().give(depthBlock(99, [0.1, 0.2], 0), documentBlock(DOCUMENT_TOPICS.debug, [line(99, 'one')]));
    for (let attempt = 0; attempt < 20; attempt += 1) {
      server().close();
      expect(live.connection).toBe('lost');
      const before = ServerEnd.opened.length;
      vi.advanceTimersByTime(3000);
      expect(ServerEnd.opened.length).toBe(before + 1);
    }
    // Twenty times three seconds have passed, on the robot's clock as well.
    server().greet({ steady: 160 });
    expect(live.connection).toBe('open');
    server().give(
      depthBlock(99, [0.1, 0.2, 0.3], 0),
      documentBlock(DOCUMENT_TOPICS.debug, [line(99, 'one'), line(99.5, 'two')]),
    );
    expect(depths()).toHaveLength(3);
    expect(live.debug.entries.map(({ text }) => text)).toEqual(['one', 'two']);
  });

  it('has the newest document of each topic, and ignores messages and topics that it does not know', () => {
    server().greet();
    for (const op of ['dance', 'toString']) server().tell({ op });
    server().give(documentBlock(DOCUMENT_TOPICS.craft, [{ time: 98, title: 'one' }, { time: 99, title: 'two' }]), documentBlock(250, [{ time: 99 }]));
    expect(live.documents.craft.value?.title).toBe('two');
    expect(live.documents.mission.value).toBeNull();
  });

  it('has the bystander’s pictures sent while somebody looks, also after the connection was lost', () => {
    const asked = () => server().sent.map((text) => JSON.parse(text) as { pictures?: string[] }).flatMap((one) => one.pictures ? [one.pictures] : []);
    const picture = (time: number) => {
      const payload = new Uint8Array(10);
      new DataView(payload.buffer).setFloat64(0, time, true);
      return blockBytes(PICTURE_TOPICS.observer, 2, 1, 0, payload);
    };
    server().greet();
    const first = live.watch('observer');
    const second = live.watch('observer');
    expect(asked()).toEqual([['picture', 'observer']]);
    server().give(picture(101));
    expect(live.pictures.observer.value?.time).toBe(101);
    server().close();
    vi.advanceTimersByTime(3000);
    server().greet({ steady: 104 });
    expect(asked()).toEqual([['picture', 'observer']]);
    first();
    expect(live.pictures.observer.value).not.toBeNull();
    second();
    expect(live.pictures.observer.value).toBeNull();
    expect(asked().at(-1)).toEqual(['picture']);
    // One is still on its way: whoever looks next is to wait for a new one.
    server().give(picture(105));
    expect(live.pictures.observer.value).toBeNull();
  });

  it('gives up a connection that has fallen silent', () => {
    server().greet();
    const silent = server();
    vi.advanceTimersByTime(3900);
    expect(live.connection).toBe('open');
    vi.advanceTimersByTime(2000);
    expect(ServerEnd.opened.at(-1)).not.toBe(silent);
  });

  it('counts samples that never came', () => {
    server().greet();
    server().give(depthBlock(99, [0.1, 0.2], 10));
    server().tell({ op: 'dropped', topic: 'depth', count: 3 });
    server().give(depthBlock(99.1, [0.3], 15));
    expect(live.gaps.missed(2)).toBe(3);
  });

  it('has events of robot and server in order of time, however they come', () => {
    const event = (time: number, text: string) => ({ time, kind: 'alarm', severity: 'alarm', text });
    server().greet();
    server().give(documentBlock(DOCUMENT_TOPICS.notice, [event(50, 'one'), event(98, 'four')]));
    server().give(documentBlock(DOCUMENT_TOPICS.event, [event(60, 'two'), event(61, 'three'), event(99, 'five')]));
    expect(live.events.entries.map(({ text }) => text)).toEqual(['one', 'two', 'three', 'four', 'five']);
  });

  it('measures age by what the line carries', () => {
    server().greet();
    server().give(depthBlock(99.9, [0.1]));
    vi.advanceTimersByTime(1300);
    expect(live.freshness('depth').state).toBe('stale');
    server().give(documentBlock(DOCUMENT_TOPICS.state, [{ time: 101, paces: [{ topic: 'depth', period: 0.5 }] }]));
    expect(live.freshness('depth').state).toBe('fresh');
  });

  it('measures the age of every row of a tick by the control rate', () => {
    server().greet();
    server().give(documentBlock(DOCUMENT_TOPICS.state, [{ time: 100, control_rate: 0.5, paces: [] }]));
    expect((['control', 'turning', 'navigation'] as const).map((topic) => live.period(topic))).toEqual([2, 2, 2]);
  });

  it('asks for a reload, and reads no rows, where definitions differ', () => {
    server().greet({ definitions: 'deadbeef' });
    server().give(depthBlock(99, [0.1]));
    expect(live.outdated).toBe(true);
    expect(live.rings.depth.length).toBe(0);
  });

  it('asks for a reload where the server has got another page', () => {
    server().greet();
    expect(live.outdated).toBe(false);
    server().close();
    vi.advanceTimersByTime(3000);
    server().greet({ page_version: 'b' });
    expect(live.outdated).toBe(true);
    // The page is the old one for as long as it is not loaded again.
    server().close();
    vi.advanceTimersByTime(3000);
    server().greet({ page_version: 'b' });
    expect(live.outdated).toBe(true);
  });

  it('forgets what was, where the robot was restarted', () => {
    server().greet({ steady: 5000 });
    server().give(depthBlock(4999, [0.1]));
    server().close();
    vi.advanceTimersByTime(3000);
    server().greet({ steady: 20 });
    server().give(depthBlock(19, [0.7]));
    expect(depths()[0]).toBeCloseTo(0.7, 6);
    expect(live.rings.depth.length).toBe(1);
    expect(live.now).toBeCloseTo(20, 3);
  });

  it.each([100, 300])('has no hole in its rows where this computer slept for %s s', (slept) => {
    server().greet();
    server().give(depthBlock(99, [0.1], 0));
    const now = performance.now.bind(performance);
    vi.spyOn(performance, 'now').mockImplementation(() => now() + slept * 1000);
    // What had come before it slept is delivered as it wakes.
    server().give(depthBlock(100, [0.2], 1));
    server().close();
    vi.advanceTimersByTime(300);
    server().greet({ steady: 100 + slept });
    server().give(depthBlock(100 + slept - 65, [0.7], 9000));
    server().give(depthBlock(100 + slept, [0.8], 9001));
    expect(depths().map((depth) => depth?.toFixed(1))).toEqual(['0.7', '0.8']);
  });

  it('gives up a connection that died while its computer slept within a second of being looked at again', () => {
    server().greet();
    // The page's own clock stood still meanwhile, so that the last message seems to be of a moment ago.
    document.dispatchEvent(new Event('visibilitychange'));
    expect(JSON.parse(server().sent.at(-1) ?? '')).toMatchObject({ op: 'ping' });
    vi.advanceTimersByTime(2000);
    expect(live.connection).toBe('lost');
  });

  it('keeps a connection that answers when it is looked at again', () => {
    server().greet();
    document.dispatchEvent(new Event('visibilitychange'));
    server().tell({ op: 'pong', id: 1 });
    vi.advanceTimersByTime(3000);
    expect(live.connection).toBe('open');
    expect(ServerEnd.opened).toHaveLength(1);
  });

  it('keeps its rows where a server that was just started has fewer of them', () => {
    server().greet();
    server().give(depthBlock(99, [0.1], 0));
    server().close();
    vi.advanceTimersByTime(20_000);
    server().greet({ steady: 120 });
    server().give(depthBlock(119, [0.7], 0));
    expect(depths()).toHaveLength(2);
  });

  it('keeps why the server ended the connection', () => {
    server().greet();
    server().close('Nothing was read for 5 s.');
    expect(live.farewell).toBe('Nothing was read for 5 s.');
  });
});

describe('a page at the control lease', () => {
  const control = (holder: number | null) =>
    ({ op: 'control', epoch: 3, holder: holder === null ? null : { client: holder, name: 'x' } }) as const;
  const calls: Request[] = [];
  const drives = () => server().sent.map((text) => JSON.parse(text) as { op: string; axes: number[]; lease: number }).filter(({ op }) => op === 'drive');

  beforeEach(() => {
    calls.length = 0;
    vi.stubGlobal('fetch', (request: Request) => {
      calls.push(request);
      return Promise.resolve(new Response('{}'));
    });
  });

  it('takes free control once, by its key', () => {
    server().greet();
    expect(access.know).toHaveBeenCalledWith(YOU);
    server().tell(control(null));
    server().tell(control(null));
    expect(calls.map(({ url, headers }) => [new URL(url).pathname, headers.get('X-Mucat-Client')])).toEqual([['/api/control/take', 'key']]);
    expect(live.barred).not.toBeNull();
    server().tell(control(7));
    expect(live.barred).toBeNull();
  });

  it('asks for no control of a lab, which has no robot', () => {
    access.lab = true;
    server().greet();
    server().tell(control(null));
    access.lab = false;
    expect(calls).toEqual([]);
  });

  it('drives while it may, and says neutral and then nothing as soon as it may not', () => {
    server().greet();
    server().tell(control(7));
    server().give(documentBlock(DOCUMENT_TOPICS.state, [{ time: 100, mode: 'manual', armed: true, alarms: [], paces: [] }]));
    vi.advanceTimersByTime(1000);
    expect(drives().length).toBeGreaterThanOrEqual(9);
    expect(drives().every(({ axes, lease }) => lease === 3 && axes.every((value) => value === 0))).toBe(true);
    server().tell(control(8));
    const before = drives().length;
    vi.advanceTimersByTime(1000);
    expect(drives().length).toBe(before + 1);
  });

  it('asks whether it is signed in still where the server sends it away or lets it in no more', () => {
    server().greet();
    server().close('Nothing was read for 5 s.', 1013);
    expect(access.check).not.toHaveBeenCalled();
    vi.advanceTimersByTime(3000);
    server().greet();
    server().close('Access was revoked by an operator.', 1008);
    expect(access.check).toHaveBeenLastCalledWith('Access was revoked by an operator.');
    vi.advanceTimersByTime(3000);
    server().close();
    expect(access.check).toHaveBeenCalledTimes(2);
  });

  it('shows the alarms of robot and server together', () => {
    const alarm = { severity: 'alarm', active: true, acknowledged: false, what: '', cause: '', remedy: '' };
    server().greet();
    const state = { time: 100, mode: 'disarmed', paces: [], alarms: [{ ...alarm, fault: 'a', since: 1 }] };
    server().give(documentBlock(DOCUMENT_TOPICS.state, [state]));
    server().tell({ op: 'alarms', alarms: [{ ...alarm, fault: 'b', since: 2 }] });
    expect(live.alarms.map(({ fault }) => fault)).toEqual(['b', 'a']);
    expect(live.alarms.map((one) => live.isUnknown(one))).toEqual([false, false]);
    vi.advanceTimersByTime(4000);
    expect(live.alarms.map((one) => live.isUnknown(one))).toEqual([false, true]);
    server().close();
    expect(live.alarms.map((one) => live.isUnknown(one))).toEqual([true, true]);
  });
});

describe('STOP', () => {
  it('goes by socket and by HTTP, until the server has taken it', async () => {
    const answers = [new Response('{"detail":"no runtime"}', { status: 503 }), new Response(null, { status: 204 })];
    let calls = 0;
    vi.stubGlobal('fetch', ({ url }: Request) => {
      calls += 1;
      expect(new URL(url).pathname).toBe('/api/robot/stop');
      // The first attempt meets no server at all.
      return calls === 1 ? Promise.reject(new TypeError('refused')) : Promise.resolve(answers[calls - 2]);
    });
    server().greet();
    live.stop.press();
    expect(server().sent).toContain('{"op":"stop"}');
    expect(live.stop.state).toBe('sending');
    await vi.advanceTimersByTimeAsync(300);
    expect(live.stop.problem).toBe('no runtime');
    await vi.advanceTimersByTimeAsync(300);
    expect(live.stop.state).toBe('confirmed');
    await vi.advanceTimersByTimeAsync(3000);
    expect(live.stop.state).toBe('idle');
    expect(calls).toBe(3);
  });

  it('is not sent any more once this page has ended', async () => {
    let calls = 0;
    vi.stubGlobal('fetch', () => {
      calls += 1;
      return Promise.resolve(new Response('{"detail":"This browser is not signed in."}', { status: 401 }));
    });
    server().greet();
    live.stop.press();
    await vi.advanceTimersByTimeAsync(300);
    end();
    const before = calls;
    await vi.advanceTimersByTimeAsync(3000);
    expect(before).toBeGreaterThan(0);
    expect(calls).toBe(before);
  });
});
