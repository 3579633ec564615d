import type { Column, RowRing } from './ring';

/** V: below, the board has no battery at its divider (firmware/src/sensors/battery.cpp). */
export const SENSED = 3;
/** V: below for 20 s, the board disarms and refuses to arm (ibid.). */
export const ALARM = 6.2;

/** s of measurements that say anything of a battery's fall */
const LEAST_SPAN = 60;
/** V/s below which it cannot be told from standing still: 10 mV in five minutes */
const LEAST_FALL = 0.01 / 300;

/** s until a voltage that goes on falling as in the ring reaches ALARM; null where it does not fall. */
export function timeToAlarm(ring: Pick<RowRing<'status'>, 'length' | 'time' | 'place'>, column: Column): number | null {
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
  if (!(slope < -LEAST_FALL)) return null;
  return Math.max(0, (ALARM - (meanVolts + slope * (last - meanTime))) / slope);
}
