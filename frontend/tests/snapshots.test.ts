import { afterEach, describe, expect, it, vi } from 'vitest';
import { Snapshots } from '../src/capture/snapshots.svelte';

const RECORDING = { id: 3 } as never;
const sent = vi.fn<(request: Request) => Promise<Response>>();
vi.stubGlobal('fetch', sent);
afterEach(() => sent.mockReset());

const answer = (status: number, body: object) => () => Promise.resolve(Response.json(body, { status }));
const make = (live: object = {}, refused: string | null = null) =>
  new Snapshots({ recording: RECORDING, replayed: false, ...live }, { refusal: () => refused });

describe('a snapshot', () => {
  it('is taken once however often the key goes down', async () => {
    sent.mockImplementation(answer(201, { session: 3, time: 12.5 }));
    const snapshots = make();
    await Promise.all([snapshots.snapshot(), snapshots.snapshot()]);
    expect(sent).toHaveBeenCalledTimes(1);
    expect(snapshots.taken).toEqual({ session: 3, time: 12.5 });
    expect(snapshots.problem).toBe('');
  });

  it('says why there is none, and forgets the one before', async () => {
    const snapshots = make();
    sent.mockImplementation(answer(201, { session: 3, time: 12.5 }));
    await snapshots.snapshot();
    sent.mockImplementation(answer(409, { detail: 'The camera does not answer. Try again.' }));
    await snapshots.snapshot();
    expect(snapshots.problem).toBe('The camera does not answer. Try again.');
    expect(snapshots.taken).toBeNull();
    expect(snapshots.busy).toBe(false);
  });

  it('needs a recording and an operator, and is nothing of a replay', async () => {
    const without = make({ recording: null });
    await without.snapshot();
    expect(without.problem).toContain('Start a recording');
    const viewer = make({}, 'Operators alone.');
    await viewer.snapshot();
    expect(viewer.problem).toBe('Operators alone.');
    const replay = make({ replayed: true });
    await replay.snapshot();
    expect(replay.problem).toBe('');
    expect(sent).not.toHaveBeenCalled();
  });
});
