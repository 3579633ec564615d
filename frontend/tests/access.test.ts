import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Access } from '../src/access/access.svelte';
import { browserName, codeIn, readingIn } from '../src/access/code';
import { linkEnd, readingAddress } from '../src/shell/readingLink';
import { api } from '../src/api';
import { nameClient } from '../src/http';

const PERSON = { device: 3, name: 'Firefox on Linux', role: 'operator', kind: 'browser', limited: false, session: null } as const;
const ME = { signed_in: true, robot: 'turtle', lab: false, identity: PERSON, ended: '', pairing_open: false, operators_only: ['startSession'], ends: null };
const NOBODY = { ...ME, signed_in: false, identity: null };
let answers: Record<string, () => Response>;
let sent: Request[];

beforeEach(() => {
  sent = [];
  answers = {};
  vi.stubGlobal('fetch', (request: Request) => {
    sent.push(request);
    const answer = answers[nameOf(request)];
    return answer ? Promise.resolve(answer()) : Promise.reject(new TypeError('refused'));
  });
});

afterEach(() => {
  nameClient(null);
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const json = (body: object, status = 200) => () => new Response(JSON.stringify(body), { status });
const nameOf = ({ method, url }: Request) => `${method} ${new URL(url).pathname}`;
const asked = () => sent.map(nameOf);

describe('signing in', () => {
  it('looks once, and shows the page to somebody who is known', async () => {
    answers['GET /api/access/me'] = json(ME);
    const access = new Access();
    expect(access.state).toBe('unknown');
    await access.open(null, 'x');
    expect(access.state).toBe('in');
    expect(asked()).toEqual(['GET /api/access/me']);
  });

  it('says why a sign-in counts no longer', async () => {
    answers['GET /api/access/me'] = json({ ...NOBODY, ended: 'This browser was not used for 90 days.' });
    const access = new Access();
    await access.open(null, 'x');
    expect(access.state).toBe('out');
    expect(access.reason).toBe('This browser was not used for 90 days.');
  });

  it('asks who follows a link for a name, and keeps its code for the sign-in', async () => {
    const access = new Access();
    answers['GET /api/access/me'] = json(NOBODY);
    await access.open('ABC', 'x');
    expect(asked()).toEqual(['GET /api/access/me']);
    expect([access.state, access.offered]).toEqual(['out', 'ABC']);
    answers['POST /api/access/pair'] = json({ ...ME, page_secret: null });
    await access.pair(access.offered, 'Ana');
    expect([access.state, access.offered]).toEqual(['in', '']);
  });

  it('gives a viewer the rights of a link without a question, and never shows the sign-in meanwhile', async () => {
    const access = new Access();
    answers['GET /api/access/me'] = json({ ...ME, identity: { ...PERSON, role: 'viewer' } });
    answers['POST /api/access/pair'] = () => {
      expect(access.state).toBe('unknown');
      return json({ ...ME, page_secret: null })();
    };
    await access.open('ABC', 'x');
    expect([access.state, access.identity?.role]).toEqual(['in', 'operator']);
  });

  it('keeps a code for others where this is an operator already', async () => {
    answers['GET /api/access/me'] = json(ME);
    await new Access().open('ABC', 'x');
    expect(asked()).toEqual(['GET /api/access/me']);
  });

  it('says why a code does not work', async () => {
    answers['GET /api/access/me'] = json(NOBODY);
    answers['POST /api/access/pair'] = json({ detail: 'This code has expired.' }, 403);
    const access = new Access();
    await access.open('ABC', 'x');
    await access.pair(access.offered, 'x');
    expect(access.state).toBe('out');
    expect([access.reason, access.offered]).toEqual(['This code has expired.', '']);
  });

  it('uses a code once more where somebody mistyped another a moment ago, and no third time', async () => {
    vi.useFakeTimers();
    const soon = () => Response.json({ detail: 'Try again in 1 s.' }, { status: 429, headers: { 'Retry-After': '1' } });
    answers['POST /api/access/pair'] = soon;
    const access = new Access();
    const opening = access.pair('ABC', 'x');
    await vi.advanceTimersByTimeAsync(900);
    expect(sent).toHaveLength(1);
    answers['POST /api/access/pair'] = json({ ...ME, page_secret: null });
    await vi.advanceTimersByTimeAsync(200);
    await opening;
    expect(access.state).toBe('in');

    answers['POST /api/access/pair'] = soon;
    const again = access.pair('ABC', 'x');
    await vi.advanceTimersByTimeAsync(1100);
    expect(await again).toBe('Try again in 1 s.');
    expect(sent).toHaveLength(4);
  });

  it.each([
    [429, '60'],
    [429, null],
    [503, '1'],
  ])('does not wait for longer, nor for other refusals (%i, %s)', async (status, wait) => {
    answers['POST /api/access/pair'] = () =>
      Response.json({ detail: 'Later.' }, { status, headers: wait === null ? {} : { 'Retry-After': wait } });
    expect(await new Access().pair('ABC', 'x')).toBe('Later.');
    expect(sent).toHaveLength(1);
  });

  it('waits for a server that does not answer yet', async () => {
    vi.useFakeTimers();
    const access = new Access();
    const opening = access.open(null, 'x');
    await vi.advanceTimersByTimeAsync(5000);
    expect(access.silent).toBe(true);
    expect(access.state).toBe('unknown');
    answers['GET /api/access/me'] = json(ME);
    await vi.advanceTimersByTimeAsync(3000);
    await opening;
    expect(access.state).toBe('in');
  });

  it('ends where any call finds that nobody is signed in, with the reason', async () => {
    answers['GET /api/access/me'] = json(ME);
    answers['GET /api/storage'] = json({ detail: 'You are not signed in.' }, 401);
    const access = new Access();
    await access.open(null, 'x');
    await api.storage();
    expect(access.state).toBe('out');
    expect(access.reason).toBe('You are not signed in.');
  });

  it('ends with the server’s reason where access was revoked, and only then', async () => {
    answers['GET /api/access/me'] = json(ME);
    const access = new Access();
    await access.open(null, 'x');
    await access.check('Your role has changed.');
    expect(access.state).toBe('in');
    answers['GET /api/access/me'] = json(NOBODY);
    await access.check('Access was revoked by an operator.');
    expect(access.state).toBe('out');
    expect(access.reason).toBe('Access was revoked by an operator.');
  });
});

describe('what every call carries', () => {
  it('is the page’s secret, and the client wherever it changes something', async () => {
    answers['GET /api/storage'] = json({});
    answers['DELETE /api/exports/1'] = () => new Response(null, { status: 204 });
    answers['POST /api/access/pair'] = json({ ...ME, page_secret: 'of this page' });
    await new Access().pair('ABC', 'x');
    nameClient('key');
    await api.storage();
    await api.deleteExport('1');
    expect(sent.map(({ headers }) => Object.fromEntries(headers)).slice(-2)).toEqual([
      { 'x-mucat': 'of this page' },
      { 'x-mucat': 'of this page', 'x-mucat-client': 'key' },
    ]);
  });
});

describe('a link', () => {
  it.each([
    ['#pair=ABC-123', 'ABC-123'],
    ['#pair=', null],
    ['#/system', null],
    ['', null],
  ])('%s carries %s', (hash, code) => expect(codeIn(hash)).toBe(code));

  it.each([
    ['Mozilla/5.0 (X11; Linux x86_64; rv:140.0) Gecko/20100101 Firefox/140.0', 'Firefox on Linux'],
    ['Mozilla/5.0 (iPhone; CPU iPhone OS 18_5 like Mac OS X) AppleWebKit/605.1.15 Version/18.5 Mobile/15E148 Safari/604.1', 'Safari on iPhone'],
    ['Mozilla/5.0 (Windows NT 10.0) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/140.0.0.0 Safari/537.36 Edg/140.0.0.0', 'Edge on Windows'],
    ['curl', 'Browser'],
  ])('names a browser', (agent, name) => expect(browserName(agent)).toBe(name));
});

describe('a reading link', () => {
  const READER = { device: 7, name: 'reading link for session 3', role: 'viewer', kind: 'reader', limited: false, session: 3 } as const;

  it('stands in what the address says is seen, and nowhere else', () => {
    expect(readingIn('#/sessions/3?at=12.5&read=AbC_-9')).toBe('AbC_-9');
    for (const hash of ['', '#/sessions/3', '#/sessions/3?read=', '#read=AbC', '#/sessions/3?reader=AbC']) expect(readingIn(hash)).toBeNull();
  });

  it('goes behind what else the address says', () => {
    expect(readingAddress('http://r/#/sessions/3', 'T')).toBe('http://r/#/sessions/3?read=T');
    expect(readingAddress('http://r/#/sessions/3?at=1', 'T')).toBe('http://r/#/sessions/3?at=1&read=T');
    expect(readingIn(new URL(readingAddress('http://r/?x=1#/replay/3', 'T')).hash)).toBe('T');
  });

  it('lets in who is not signed in, until it ends', async () => {
    answers['GET /api/access/me'] = json(NOBODY);
    answers['POST /api/access/read'] = json({ ...ME, identity: READER, operators_only: ['startExport'], ends: 2e9, page_secret: 'p' });
    const access = new Access();
    await access.open(null, 'x', 'token');
    expect([access.state, access.reads, access.ends]).toEqual(['in', 3, 2e9]);
    expect(access.refusal('startExport')).toMatch(/reading link/);
  });

  it('waits for a server that does not answer yet', async () => {
    vi.useFakeTimers();
    answers['GET /api/access/me'] = json(NOBODY);
    const access = new Access();
    const opening = access.open(null, 'x', 'token');
    await vi.advanceTimersByTimeAsync(1000);
    expect([access.state, access.silent]).toEqual(['unknown', true]);
    answers['POST /api/access/read'] = json({ ...ME, identity: READER, operators_only: [], ends: 2e9, page_secret: null });
    await vi.advanceTimersByTimeAsync(3000);
    await opening;
    expect([access.state, access.reads]).toEqual(['in', 3]);
  });

  it('is not used by who is signed in', async () => {
    answers['GET /api/access/me'] = json(ME);
    const access = new Access();
    await access.open(null, 'x', 'token');
    expect([access.state, access.reads]).toEqual(['in', null]);
    expect(asked()).toEqual(['GET /api/access/me']);
  });

  it('says why it opens nothing, also to who reads by another', async () => {
    answers['POST /api/access/read'] = json({ detail: 'This reading link ended on Monday.' }, 403);
    for (const identity of [null, READER]) {
      answers['GET /api/access/me'] = json({ ...ME, identity, signed_in: identity !== null });
      const access = new Access();
      await access.open(null, 'x', 'token');
      expect([access.state, access.reason]).toEqual(['out', 'This reading link ended on Monday.']);
    }
  });

  it('ends after a day, a week, or with a day of the calendar that is not over', () => {
    const now = new Date('2026-11-29T12:00:00').getTime();
    expect(linkEnd('day', '', now)).toBe(now / 1000 + 86_400);
    expect(linkEnd('week', '', now)).toBe(now / 1000 + 604_800);
    expect(linkEnd('date', '2026-11-29', now)).toBe(new Date('2026-11-29T23:59:59').getTime() / 1000);
    for (const date of ['', '2026-11-28', 'nonsense', '2026-13-45']) expect(linkEnd('date', date, now)).toBeNull();
  });
});
