import { expect, it } from 'vitest';
import type { LinkRow } from '../src/generated/topics';
import { linkFacts } from '../src/parts/linkFacts';

const LINE = { connection: 'connected', port: 'serial0', baud: 9600 };
const ROW: LinkRow = {
  time: 1,
  bytes_received: 5000,
  bytes_sent: 1200,
  bytes_delivered: 4000,
  frames_received: 99,
  frames_sent: 80,
  frames_invalid: 2,
  frames_missed: 1,
  frames_repeated: 3,
  frames_duplicate: 4,
  messages_discarded: 5,
  round_trip: 0.0482,
  round_trip_deviation: 0.0226,
  timeout: 0.1,
  goodput: 480,
  credit: 255,
  clock_error: 0.00012,
  clock_drift: 0.00002,
};

const said = (facts: ReturnType<typeof linkFacts>) => Object.fromEntries(facts.map(({ name, value }) => [name, value]));

it('shows every figure of the line', () => {
  expect(said(linkFacts(LINE, ROW))).toMatchObject({
    'Round trip': '48.2 ± 22.6',
    'Retransmit timeout': '100.0',
    Received: '99 frames, 5.0 kB',
    Sent: '80 frames, 1.2 kB',
    Delivered: '0.48 kB/s (50 %)',
    'Frames missed': '1 (1.00 %)',
    'Frames invalid': '2',
    'Frames retransmitted': '3',
    'Duplicate frames': '4',
    'Messages discarded': '5',
    'Receive buffer': '255',
    'Clock uncertainty': '0.12',
    'Clock drift': '20',
  });
});

it('says of each figure what it means', () => {
  const bare = linkFacts(LINE, ROW).filter((fact) => !('meaning' in fact));
  expect(bare.map(({ name }) => name)).toEqual(['Connection', 'Port']);
});

it('has nothing to show before the first word', () => {
  expect(new Set(linkFacts(null, null).map(({ value }) => value))).toEqual(new Set(['–']));
});
