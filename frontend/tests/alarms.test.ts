import { describe, expect, it } from 'vitest';
import type { Alarm } from '../src/generated/topics';
import { groupAlarms, severityOf, type AlarmGroup } from '../src/live/alarms';

function alarm(fault: string, since: number, changes: Partial<Alarm> = {}): Alarm {
  const texts = { what: '', cause: '', remedy: '' };
  return { fault, since, until: null, severity: 'alarm', active: true, acknowledged: false, consequences: [], ...texts, ...changes };
}

const named = (groups: AlarmGroup[]) => groups.map(({ cause, consequences }) => [cause.fault, consequences.map(({ fault }) => fault)]);

describe('groupAlarms', () => {
  const simulator = alarm('simulator_silent', 10, { consequences: ['depth_frozen', 'imu_stale'] });

  it('shows a cause before what follows from it, also where that was noticed earlier', () => {
    const alarms = [alarm('imu_stale', 9.7), simulator, alarm('depth_frozen', 10.2), alarm('capsized', 8)];
    expect(named(groupAlarms(alarms))).toEqual([
      ['simulator_silent', ['depth_frozen', 'imu_stale']],
      ['capsized', []],
    ]);
  });

  it('leaves the consequence of a consequence beneath the first cause', () => {
    const frozen = alarm('depth_frozen', 10.2, { consequences: ['not_rising'] });
    expect(named(groupAlarms([alarm('not_rising', 29), frozen, simulator]))).toEqual([
      ['simulator_silent', ['not_rising', 'depth_frozen']],
    ]);
  });

  it('leaves alone what began long before the cause, or long after its end', () => {
    expect(named(groupAlarms([alarm('imu_stale', 4), simulator]))).toEqual([['simulator_silent', []], ['imu_stale', []]]);
    const over = { ...simulator, active: false, until: 20 };
    expect(named(groupAlarms([alarm('imu_stale', 24), over]))).toEqual([['simulator_silent', ['imu_stale']]]);
    expect(named(groupAlarms([alarm('imu_stale', 26), over]))).toEqual([['imu_stale', []], ['simulator_silent', []]]);
  });

  it('puts a group where the most urgent of it belongs', () => {
    const seen = { ...simulator, acknowledged: true, severity: 'caution' as const };
    const groups = groupAlarms([alarm('disk_low', 50, { severity: 'caution' }), seen, alarm('imu_stale', 60)]);
    expect(named(groups)).toEqual([['simulator_silent', ['imu_stale']], ['disk_low', []]]);
    expect(groups.map(severityOf)).toEqual(['alarm', 'caution']);
  });

  it('reads alarms of recordings that name no consequences', () => {
    const old = { ...simulator, consequences: undefined, until: undefined };
    expect(named(groupAlarms([old as unknown as Alarm, alarm('imu_stale', 10)]))).toHaveLength(2);
  });
});
