import { afterEach, describe, expect, it, vi } from 'vitest';
import { api, refuseCommands } from '../src/api';

afterEach(() => {
  refuseCommands(null);
  vi.unstubAllGlobals();
});

describe('a page that may not command', () => {
  it('sends nothing to the robot but STOP', async () => {
    const sent: string[] = [];
    vi.stubGlobal('fetch', (address: string) => {
      sent.push(address);
      return Promise.resolve(new Response(null, { status: 204 }));
    });
    refuseCommands('a replay');
    const orders = [
      () => api.arm('manual'),
      () => api.changeMode('automatic'),
      () => api.checkFins(),
      () => api.acknowledge(),
      () => api.controller('pid', {}),
      () => api.setPoints({ default: 1 }),
      () => api.card(null),
      () => api.vision({ rate: 4 }),
    ];
    for (const order of orders) expect(await order()).toBe('a replay');
    expect(sent).toEqual([]);
    expect(await api.stop()).toBeNull();
    expect(sent).toEqual(['/api/robot/stop']);
    refuseCommands(null);
    expect(await api.arm('manual')).toBeNull();
  });
});
