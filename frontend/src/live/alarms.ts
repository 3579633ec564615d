import type { Alarm } from '../generated/topics';

const URGENCY = { alarm: 0, caution: 1, info: 2 } as const;
/** s by which a consequence may begin before its cause is noticed (pilot_quiet, before server_silent), or after its end */
const APART = 5;

/** An alarm, and those that follow from it. */
export interface AlarmGroup {
  readonly cause: Alarm;
  readonly consequences: readonly Alarm[];
}

/** The most urgent comes first: one that nobody has acknowledged, then what is wrong still, then by severity, then the newest. */
function compare(one: Alarm, other: Alarm): number {
  const rank = (alarm: Alarm) => [alarm.acknowledged ? 1 : 0, alarm.active ? 0 : 1, URGENCY[alarm.severity], -alarm.since];
  const theirs = rank(other);
  return rank(one).map((value, place) => value - (theirs[place] ?? 0)).find((apart) => apart !== 0) ?? 0;
}

/** `consequences` and `until` are missing in recordings of earlier versions. */
function follows(alarm: Alarm, from: Partial<Alarm> & Pick<Alarm, 'since'>): boolean {
  const near = alarm.since >= from.since - APART && alarm.since <= (from.until ?? Infinity) + APART;
  return near && (from.consequences ?? []).includes(alarm.fault);
}

function rootOf(alarm: Alarm, alarms: readonly Alarm[]): Alarm {
  // The server refuses to start with faults that follow from themselves, so this ends.
  const cause = alarms.find((one) => follows(alarm, one));
  return cause === undefined ? alarm : rootOf(cause, alarms);
}

/** Every alarm once: first causes, each with all that follows from it; a group is as urgent as the most urgent of it. */
export function groupAlarms(alarms: readonly Alarm[]): AlarmGroup[] {
  const sorted = [...alarms].sort(compare);
  const groups = new Map<Alarm, Alarm[]>();
  for (const alarm of sorted) {
    const root = rootOf(alarm, sorted);
    const members = groups.get(root) ?? [];
    if (alarm !== root) members.push(alarm);
    groups.set(root, members);
  }
  return [...groups].map(([cause, consequences]) => ({ cause, consequences }));
}

export const membersOf = ({ cause, consequences }: AlarmGroup): Alarm[] => [cause, ...consequences];

/** The worst severity in a group, of those that are not acknowledged where there are such. */
export function severityOf(group: AlarmGroup): Alarm['severity'] {
  return membersOf(group).sort(compare)[0]?.severity ?? group.cause.severity;
}

export const unacknowledged = (alarms: readonly Alarm[]): number => alarms.filter((alarm) => !alarm.acknowledged).length;
