import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { api } from '../src/api';
import { address, NO_ANSWER, onUnconfirmed, robot, server } from '../src/http';

let sent: { request: Request; body: unknown }[];
let answers: Response[];

beforeEach(() => {
  sent = [];
  vi.stubGlobal('fetch', async (request: Request) => {
    sent.push({ request, body: request.body === null ? null : await request.json() });
    return answers.shift();
  });
});

afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
  onUnconfirmed(() => Promise.resolve(false));
});

const asksConfirmation = () => Response.json({ detail: 'Confirm first.', kind: 'confirmation' }, { status: 403 });

describe('a request', () => {
  it('is sent once more as it was where it gets the confirmation that the server asks for', async () => {
    answers = [asksConfirmation(), Response.json({ code: 'ABC' }, { status: 201 })];
    onUnconfirmed(() => Promise.resolve(true));
    expect(await api.invite('viewer')).toEqual({ value: { code: 'ABC' } });
    expect(sent.map(({ body }) => body)).toEqual([{ role: 'viewer' }, { role: 'viewer' }]);
  });

  it('is refused in the words of the server where nobody confirms', async () => {
    answers = [asksConfirmation()];
    expect(await api.invite('viewer')).toEqual({ problem: 'Confirm first.', kind: 'confirmation' });
  });

  it('is given up after its own time, counted anew for each attempt', async () => {
    const times = vi.spyOn(AbortSignal, 'timeout');
    answers = [asksConfirmation(), Response.json([]), Response.json({}), new Response('x')];
    onUnconfirmed(() => Promise.resolve(true));
    await api.examine();
    await api.health();
    await api.backup(() => undefined);
    expect(times.mock.calls).toEqual([[120_000], [120_000], [5000]]);
  });

  it('is sent anew where no answer comes, unless it changes something', async () => {
    vi.useFakeTimers();
    const refuses = vi.fn<typeof fetch>().mockRejectedValue(new TypeError('refused'));
    vi.stubGlobal('fetch', refuses.mockRejectedValueOnce(new TypeError('refused')).mockRejectedValueOnce(new DOMException('', 'TimeoutError')).mockResolvedValueOnce(Response.json([])));
    const asked = api.layouts();
    await vi.advanceTimersByTimeAsync(3000);
    expect(await asked).toEqual({ value: [] });
    expect(refuses).toHaveBeenCalledTimes(3);

    const never = api.layouts();
    await vi.advanceTimersByTimeAsync(3000);
    expect(await never).toMatchObject({ kind: NO_ANSWER });
    expect(refuses).toHaveBeenCalledTimes(6);
    expect(await api.command('acknowledge', {})).not.toBeNull();
    expect(refuses).toHaveBeenCalledTimes(7);
  });

  it('does not burden a busy server twice with what takes long', async () => {
    const late = vi.fn<typeof fetch>().mockRejectedValue(new DOMException('', 'TimeoutError'));
    vi.stubGlobal('fetch', late);
    expect(await api.story(3)).toMatchObject({ kind: NO_ANSWER });
    expect(late).toHaveBeenCalledTimes(1);
  });

  it('has its parameters in its address, each tag by itself', async () => {
    answers = [Response.json([], { headers: { 'Total-Count': '7' } })];
    expect(await api.sessions({ search: 'a b', tag: ['x', 'y'], before: 3 })).toEqual({ value: { sessions: [], total: 7 } });
    expect(sent[0]?.request.url).toBe('http://localhost:8000/api/sessions?search=a%20b&tag=x&tag=y&before=3');
    expect(api.thumbnail(4, 1.5)).toBe('/api/sessions/4/thumbnail?time=1.5');
    expect(api.profileFile(2)).toBe('/api/profiles/2/file');
  });

  it('has no bytes where the server has none', async () => {
    answers = [new Response(null, { headers: { 'Content-Length': '0' } })];
    expect(await api.past(['depth'], 3)).toEqual({ value: new ArrayBuffer(0) });
  });

  it('has no words of the server where something between answers in its place', async () => {
    answers = [new Response('<html>', { status: 502 })];
    expect(await api.health()).toMatchObject({ problem: expect.stringContaining('502') as string, kind: '' });
  });
});

/** What must not compile: a route, a parameter, a field and an answer that the server does not have. */
export async function refused(): Promise<void> {
  // @ts-expect-error no such route
  await server.GET('/api/profile');
  // @ts-expect-error no such method there
  await server.GET('/api/robot/stop');
  // @ts-expect-error no such parameter of the path
  await server.GET('/api/sessions/{session}', { params: { path: { id: 1 } } });
  // @ts-expect-error no such parameter of the query
  await server.GET('/api/sessions', { params: { query: { tags: ['x'] } } });
  // @ts-expect-error no query at all
  await server.GET('/api/health', { params: { query: { part: 'board' } } });
  // @ts-expect-error no such field
  await robot.PUT('/api/simulator', { body: { there: true } });
  // @ts-expect-error no such command
  await api.command('dance', {});
  // @ts-expect-error no such field of a command
  await api.command('arm', { mode: 'manual', safe: true });
  // @ts-expect-error no such file
  address('/api/profiles/{profile}/text', { path: { profile: 1 } });
  const answer = await api.storage();
  // @ts-expect-error no such field of an answer
  if ('value' in answer) void answer.value.room;
}
