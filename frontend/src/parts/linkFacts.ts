import type { LinkRow, State } from '../generated/topics';
import { bytes, count, fixed, MISSING } from '../format';

const BITS_PER_BYTE = 10;
const MS = 1000;

type Line = Pick<State, 'connection' | 'port' | 'baud'>;

/** The line's figures with their units, each with a line that says what it means; all missing while there are none. */
export function linkFacts(state: Line | null, link: LinkRow | null) {
  const number = (value: number | undefined) => (value === undefined ? MISSING : count(value));
  const ms = (value: number | undefined, decimals: number) => fixed(value === undefined ? null : value * MS, decimals);
  return [
    { name: 'Connection', value: state?.connection ?? MISSING },
    { name: 'Port', value: state?.port ?? MISSING },
    { name: 'Speed', value: number(state?.baud), unit: 'baud', meaning: 'Set in robot.toml (link.baud), and compiled into the firmware' },
    {
      name: 'Round trip',
      value: link ? `${ms(link.round_trip, 1)} ± ${ms(link.round_trip_deviation, 1)}` : MISSING,
      unit: 'ms',
      meaning: 'From a reliable frame to its acknowledgement: smoothed mean and mean deviation',
    },
    { name: 'Repeats after', value: ms(link?.timeout, 1), unit: 'ms', meaning: 'How long an acknowledgement is waited for before the frame goes out again' },
    { name: 'Received', value: link ? `${count(link.frames_received)} frames, ${bytes(link.bytes_received)}` : MISSING, meaning: 'Valid frames, and all bytes, since the port was opened' },
    { name: 'Sent', value: link ? `${count(link.frames_sent)} frames, ${bytes(link.bytes_sent)}` : MISSING, meaning: 'Frames and bytes since the port was opened' },
    {
      name: 'Delivered',
      value: link ? `${fixed(link.goodput / 1000, 2)} kB/s (${fixed(share(link.goodput, state), 0)} %)` : MISSING,
      meaning: "What the received messages carried in the last second, and as a share of what the line could carry without any frames around it",
    },
    { name: 'Frames missed', value: link ? `${count(link.frames_missed)} (${fixed(missedShare(link), 2)} %)` : MISSING, meaning: "Gaps in the numbers of the board's telemetry: sent and never arrived, or dropped for want of room" },
    { name: 'Frames invalid', value: number(link?.frames_invalid), meaning: 'Thrown away: garbage, a wrong checksum or a wrong length' },
    { name: 'Frames repeated', value: number(link?.frames_repeated), meaning: 'Reliable frames sent again because no acknowledgement came' },
    { name: 'Frames doubled', value: number(link?.frames_duplicate), meaning: 'Arrived a second time, and were not passed on again' },
    { name: 'Messages discarded', value: number(link?.messages_discarded), meaning: 'Not acknowledged when the board restarted: meant for another boot' },
    { name: "Board's room", value: number(link?.credit), unit: 'B', meaning: 'Credit: how many bytes the board can take in at once' },
    { name: "Board's clock, uncertain by", value: ms(link?.clock_error, 2), unit: 'ms', meaning: "Standard deviation of the board's time, mapped to this computer's" },
    { name: "Board's clock, slow by", value: fixed(link ? link.clock_drift * 1e6 : null, 0), unit: 'ppm', meaning: "How much the board's clock is behind this computer's, in millionths" },
  ];
}

/** %; null where the speed is not known */
const share = (goodput: number, state: Line | null): number | null => (state === null ? null : (100 * goodput * BITS_PER_BYTE) / state.baud);

/** %; null before the first frame */
function missedShare(link: LinkRow): number | null {
  const all = link.frames_received + link.frames_missed;
  return all === 0 ? null : (100 * link.frames_missed) / all;
}
