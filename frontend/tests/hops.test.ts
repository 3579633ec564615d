import { describe, expect, it } from 'vitest';
import { findBroken, type Heard } from '../src/live/hops';

const WELL: Heard = {
  connection: 'open',
  farewell: '',
  untrusted: false,
  parts: [{ name: 'runtime', state: 'ok', text: 'It runs.', here: null }],
  silent: false,
  state: { connected: true, connection: 'connected' },
};

describe('findBroken', () => {
  it('finds nothing where all is well, or while nothing is known yet', () => {
    expect(findBroken(WELL)).toBeNull();
    expect(findBroken({ ...WELL, connection: 'connecting', silent: true })).toBeNull();
    expect(findBroken({ ...WELL, parts: [], silent: true, state: null })).toBeNull();
  });

  it('blames the hop nearest to the page', () => {
    const all: Heard = { ...WELL, silent: true, state: { connected: false, connection: 'no answer' } };
    expect(findBroken({ ...all, connection: 'lost' })?.hop).toBe(0);
    expect(findBroken(all)?.hop).toBe(1);
    expect(findBroken({ ...all, silent: false })?.hop).toBe(2);
  });

  it.each(['starting', 'failed'] as const)('says in the words of the server that the runtime is %s', (state) => {
    const broken = findBroken({ ...WELL, parts: [{ name: 'runtime', state, text: 'Exit code 3', here: null }] });
    expect(broken?.hop).toBe(1);
    expect(broken?.what).toContain('Exit code 3');
  });

  it('says calmly which work the board does instead of the runtime’s', () => {
    const broken = findBroken({ ...WELL, silent: true, parts: [{ name: 'runtime', state: 'absent', text: 'The bring-up uses it.', here: null }] });
    expect(broken).toMatchObject({ what: 'The bring-up uses it.', reserved: true });
    expect(findBroken({ ...WELL, silent: true })?.reserved).toBeUndefined();
  });

  it('says how to trust the certificate where HTTPS works and the live connection does not', () => {
    const broken = findBroken({ ...WELL, connection: 'lost', untrusted: true });
    expect(broken?.what).toMatch(/does not trust the robot’s certificate.*STOP works/);
    expect(findBroken({ ...WELL, untrusted: true })).toBeNull();
  });

  it('passes on why the server ended the connection', () => {
    const broken = findBroken({ ...WELL, connection: 'lost', farewell: '50 pages are open already; close one.' });
    expect(broken?.what).toMatch(/^50 pages are open already; close one\. /);
  });
});
