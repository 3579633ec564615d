import type { Alarm } from '../generated/topics';

const URGENCY = { alarm: 0, caution: 1, info: 2 } as const;

/** Those that nobody has acknowledged first, then what is wrong still, then by how bad it is, then the newest. */
export function inOrder(alarms: readonly Alarm[]): Alarm[] {
  const rank = (alarm: Alarm) => [alarm.acknowledged ? 1 : 0, alarm.active ? 0 : 1, URGENCY[alarm.severity], -alarm.since];
  return [...alarms].sort((one, other) => {
    const theirs = rank(other);
    return rank(one).map((value, place) => value - (theirs[place] ?? 0)).find((apart) => apart !== 0) ?? 0;
  });
}

export const unacknowledged = (alarms: readonly Alarm[]): number => alarms.filter((alarm) => !alarm.acknowledged).length;
