import { degrees, euler } from '../attitude';
import { loopOf } from '../drive/holds';
import type { Rows } from '../generated/topics';
import { freshness } from '../live/freshness';
import type { Live } from '../live/live.svelte';
import type { RowRing } from '../live/ring';

/** s; samples come in bundles: so late each is shown at its own time, and none is made up between two */
const LATE = 0.05;

/** A value with its age (s) where that makes it stale. */
export interface Aged<Value> {
  readonly value: Value;
  readonly old: number | null;
}

export interface Readings {
  /** m */
  readonly depth: Aged<number> | null;
  /** °; roll right side down, pitch nose up, heading from north */
  readonly attitude: Aged<{ readonly roll: number; readonly pitch: number; readonly heading: number }> | null;
  /** m and °; null where nothing holds it */
  readonly depthHeld: number | null;
  readonly headingHeld: number | null;
}

/** The sample that is due at `time` (s, steady clock): the last one that is not later, or else the oldest. */
export function sampleAt<K extends 'imu' | 'depth'>(ring: RowRing<K>, time: number): Rows[K] | null {
  if (ring.length === 0) return null;
  if (Number.isNaN(time)) return ring.latest();
  const later = ring.firstSince(time);
  const due = later < ring.length && ring.time[ring.place(later)] === time ? later : later - 1;
  return ring.row(Math.max(0, due));
}

/** Values to show now. */
export function readingsOf(live: Live): Readings {
  const now = live.instantNow;
  const old = (topic: 'imu' | 'depth') => {
    const { state, age } = freshness(live.rings[topic].newest, now, live.period(topic));
    return state === 'stale' || live.connection !== 'open' ? age : null;
  };
  const imu = sampleAt(live.rings.imu, now - LATE);
  const depth = sampleAt(live.rings.depth, now - LATE);
  const turned = imu && euler(imu.attitude);
  const held = (name: 'depth' | 'heading') => {
    const loop = live.state?.armed ? loopOf(live.state, name) : null;
    return loop?.on ? loop.set_point : null;
  };
  const heading = held('heading');
  // The controller's set point moves, that of the state is where it will be.
  const control = freshness(live.rings.control.newest, now, live.period('control')).state === 'fresh' ? live.rings.control.latest() : null;
  return {
    depth: depth && { value: depth.depth, old: old('depth') },
    attitude: turned && {
      value: { roll: degrees(turned.roll), pitch: degrees(turned.pitch), heading: (degrees(turned.yaw) + 360) % 360 },
      old: old('imu'),
    },
    depthHeld: held('depth') === null ? null : (control?.set_point ?? held('depth')),
    headingHeld: heading === null ? null : (degrees(heading) + 360) % 360,
  };
}
