import type { LinkRow, State } from '../generated/topics';
import { bytes, count, fixed, MISSING } from '../format';
import { link as texts } from '../texts/link';

const BITS_PER_BYTE = 10;
const MS = 1000;

type Line = Pick<State, 'connection' | 'port' | 'baud'>;

/** The line's figures with their units, each with a line that says what it means; all missing while there are none. */
export function linkFacts(state: Line | null, link: LinkRow | null) {
  const number = (value: number | undefined) => (value === undefined ? MISSING : count(value));
  const ms = (value: number | undefined, decimals: number) => fixed(value === undefined ? null : value * MS, decimals);
  return [
    { name: texts.connection, value: state?.connection ?? MISSING },
    { name: texts.port, value: state?.port ?? MISSING },
    { ...texts.baud, value: number(state?.baud), unit: 'baud' },
    { ...texts.roundTrip, value: link ? `${ms(link.round_trip, 1)} ± ${ms(link.round_trip_deviation, 1)}` : MISSING, unit: 'ms' },
    { ...texts.timeout, value: ms(link?.timeout, 1), unit: 'ms' },
    { ...texts.received, value: link ? texts.framesAndBytes(count(link.frames_received), bytes(link.bytes_received)) : MISSING },
    { ...texts.sent, value: link ? texts.framesAndBytes(count(link.frames_sent), bytes(link.bytes_sent)) : MISSING },
    { ...texts.delivered, value: link ? `${fixed(link.goodput / 1000, 2)} kB/s (${fixed(share(link.goodput, state), 0)} %)` : MISSING },
    { ...texts.missed, value: link ? `${count(link.frames_missed)} (${fixed(missedShare(link), 2)} %)` : MISSING },
    { ...texts.invalid, value: number(link?.frames_invalid) },
    { ...texts.retransmitted, value: number(link?.frames_repeated) },
    { ...texts.duplicate, value: number(link?.frames_duplicate) },
    { ...texts.discarded, value: number(link?.messages_discarded) },
    { ...texts.buffer, value: number(link?.credit), unit: 'B' },
    { ...texts.clockError, value: ms(link?.clock_error, 2), unit: 'ms' },
    { ...texts.clockDrift, value: fixed(link ? link.clock_drift * 1e6 : null, 0), unit: 'ppm' },
  ];
}

/** %; null where the speed is not known */
const share = (goodput: number, state: Line | null): number | null => (state === null ? null : (100 * goodput * BITS_PER_BYTE) / state.baud);

/** %; null before the first frame */
function missedShare(link: LinkRow): number | null {
  const all = link.frames_received + link.frames_missed;
  return all === 0 ? null : (100 * link.frames_missed) / all;
}
