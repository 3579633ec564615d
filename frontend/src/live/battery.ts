import type { TunableParameter } from '../generated/topics';
import type { Column, RowRing } from './ring';

/** V: below, the board has no battery at its divider (firmware/src/sensors/battery.cpp). */
export const SENSED = 3;
/** V: default and least value of the parameter battery.alarm (robot_runtime/contract/packets/chip_parameters.py) */
const ALARM_LEAST = 6.2;

/** s of measurements that say anything of a battery's fall */
const LEAST_SPAN = 60;
/** V/s below which it cannot be told from standing still: 10 mV in five minutes */
const LEAST_FALL = 0.01 / 300;

/** Voltage (V) below which the board disarms and refuses to arm after 20 s. */
export function alarmVoltage(parameters: readonly TunableParameter[] | null): number {
  return Number(parameters?.find(({ name }) => name === 'battery.alarm')?.value ?? ALARM_LEAST);
}

/**
 * Time (s) until a voltage that goes on falling as in the ring reaches `alarm` (V); Infinity where it does not fall,
 * null where the ring covers too little time to say.
 */
export function timeToAlarm(
  ring: Pick<RowRing<'status'>, 'length' | 'time' | 'place'>,
  column: Column,
  alarm: number,
): number | null {
  const { length } = ring;
  let meanTime = 0;
  let meanVolts = 0;
  let spread = 0;
  let shared = 0;
  // Least squares in one pass (Welford).
  for (let order = 0; order < length; order += 1) {
    const place = ring.place(order);
    const time = ring.time[place] ?? NaN;
    const volts = column[place] ?? NaN;
    const away = time - meanTime;
    meanTime += away / (order + 1);
    meanVolts += (volts - meanVolts) / (order + 1);
    spread += away * (time - meanTime);
    shared += away * (volts - meanVolts);
  }
  const first = length > 0 ? (ring.time[ring.place(0)] ?? NaN) : NaN;
  const last = length > 0 ? (ring.time[ring.place(length - 1)] ?? NaN) : NaN;
  if (!(last - first >= LEAST_SPAN)) return null;
  const slope = shared / spread;
  if (!(slope < -LEAST_FALL)) return Infinity;
  return Math.max(0, (alarm - (meanVolts + slope * (last - meanTime))) / slope);
}
