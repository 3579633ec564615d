import { describe, expect, it } from 'vitest';
import { SoundEvents, type Heard } from '../src/sound/events';
import { SoundPlayer } from '../src/sound/player';

const REST: Heard = { armed: false, alarms: [], linked: true, mission: null };
const alarm = (fault: string, since: number, severity: 'alarm' | 'caution' = 'alarm') => ({ fault, since, severity, active: true, what: `${fault} is so.` });
const mission = (number: number, phase: 'running' | 'paused' | 'succeeded' | 'failed') => ({ number, phase, title: 'Two depths' });

/** The kinds that a series of states sounds like, a second apart. */
function kinds(...states: Partial<Heard>[]): string[] {
  const events = new SoundEvents();
  return [REST, ...states].flatMap((state, second) => events.take({ ...REST, ...state }, second).map(({ kind }) => kind));
}

describe('which event gives which sound', () => {
  it('hears arming and disarming, each once', () => {
    expect(kinds({ armed: true }, { armed: true }, {}, {})).toEqual(['armed', 'disarmed']);
  });

  it('is silent about what was so before the page came', () => {
    const events = new SoundEvents();
    const first = { armed: true, alarms: [alarm('leak', 1)], linked: true, mission: mission(1, 'succeeded') };
    expect(events.take({ ...REST, armed: null, linked: null }, 0)).toEqual([]);
    expect(events.take(first, 1)).toEqual([]);
    expect(events.take(first, 2)).toEqual([]);
  });

  it('hears each new alarm, says what it is, and no caution', () => {
    const events = new SoundEvents();
    events.take(REST, 0);
    const alarms = [alarm('capsized', 1), alarm('pilot_quiet', 1, 'caution')];
    expect(events.take({ ...REST, alarms }, 1)).toEqual([{ kind: 'alarm', words: 'Alarm. capsized is so.' }]);
    expect(events.take({ ...REST, alarms }, 2)).toEqual([]);
  });

  it('has a tone of its own for the battery', () => {
    expect(kinds({ alarms: [alarm('battery_low', 1)] })).toEqual(['battery']);
  });

  it('hears an alarm that comes and goes once', () => {
    const flapping = Array.from({ length: 20 }, (_, second) => ({ alarms: second % 2 === 0 ? [alarm('depth_stale', second)] : [] }));
    expect(kinds(...flapping)).toEqual(['alarm']);
    const events = new SoundEvents();
    events.take(REST, 0);
    expect(events.take({ ...REST, alarms: [alarm('leak', 1)] }, 1)).toHaveLength(1);
    events.take(REST, 2);
    expect(events.take({ ...REST, alarms: [alarm('leak', 60)] }, 60)).toHaveLength(1);
  });

  it('hears a lost connection once, however often it is tried again', () => {
    expect(kinds({ linked: false }, { linked: null, armed: null }, { linked: false }, { linked: true }, { linked: false })).toEqual(['lost']);
  });

  it('hears that the robot was disarmed while nothing was heard of it', () => {
    expect(kinds({ armed: true }, { armed: null, linked: false }, { armed: false })).toEqual(['armed', 'lost', 'disarmed']);
  });

  it('hears the end of a mission that ran, whether paused or not', () => {
    expect(kinds({ mission: mission(1, 'running') }, { mission: mission(1, 'succeeded') }, { mission: mission(1, 'succeeded') })).toEqual(['mission']);
    expect(kinds({ mission: mission(1, 'paused') }, { mission: mission(1, 'failed') })).toEqual(['mission']);
    expect(kinds({ mission: mission(1, 'succeeded') })).toEqual([]);
  });

  it('puts the most urgent first', () => {
    expect(kinds({ armed: true }, { armed: false, alarms: [alarm('battery_low', 1), alarm('leak', 1)] })).toEqual(['armed', 'alarm', 'battery', 'disarmed']);
  });
});

describe('a browser without sound', () => {
  it('says so and does no harm', async () => {
    const player = new SoundPlayer();
    await player.wake();
    expect(player.problem(true)).toBe('This browser plays no tones.');
    player.play([{ kind: 'alarm', words: 'Alarm.' }], 'full', true);
    player.close();
  });
});
