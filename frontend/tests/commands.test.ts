import { afterEach, describe, expect, it, vi } from 'vitest';
import { api, refuseCommands } from '../src/api';

afterEach(() => {
  refuseCommands(null);
  vi.unstubAllGlobals();
});

describe('a page that may not command', () => {
  it('sends nothing to the robot but STOP', async () => {
    const sent: string[] = [];
    vi.stubGlobal('fetch', ({ url }: Request) => {
      sent.push(new URL(url).pathname);
      return Promise.resolve(new Response(null, { status: 204 }));
    });
    refuseCommands('a replay');
    const orders = [
      () => api.command('arm', { mode: 'manual' }),
      () => api.command('mode', { mode: 'automatic' }),
      () => api.command('check_fins', {}),
      () => api.command('acknowledge', {}),
      () => api.command('loop', { name: 'depth', controller: 'pid' }),
      () => api.command('parameters', { values: { 'control.set_point': 1 } }),
      () => api.command('card', {}),
      () => api.command('steering', { by: 'none' }),
    ];
    for (const order of orders) expect(await order()).toBe('a replay');
    expect(sent).toEqual([]);
    expect(await api.stop()).toBeNull();
    expect(sent).toEqual(['/api/robot/stop']);
    refuseCommands(null);
    expect(await api.command('arm', { mode: 'manual' })).toBeNull();
  });
});
