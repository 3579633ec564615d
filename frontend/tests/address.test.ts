import { afterEach, describe, expect, it, vi } from 'vitest';
import { rememberAddress } from '../src/router.svelte';

describe('the address', () => {
  afterEach(() => vi.unstubAllGlobals());

  it('is the same until somebody goes on', () => {
    const location = { hash: '#/comm-tests' };
    vi.stubGlobal('location', location);
    const stillHere = rememberAddress();
    expect(stillHere()).toBe(true);
    location.hash = '#/operate';
    expect(stillHere()).toBe(false);
  });
});
