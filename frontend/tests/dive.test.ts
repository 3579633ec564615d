import { describe, expect, it } from 'vitest';
import { judgeDive, type DiveFacts } from '../src/pages/missions/dive';

const READY: DiveFacts = {
  battery: 8.2,
  left: null,
  alarm: 6.2,
  missing: [],
  depth: 0.01,
  free: 20e9,
  ahead: -2,
  wet: false,
  weighed: true,
  mission: { longest: 665, unwatched: 0 },
};

function judged(more: Partial<DiveFacts>) {
  return Object.fromEntries(judgeDive({ ...READY, ...more }).map(({ name, verdict, text }) => [name, [verdict, text]]));
}

describe('the checks before a dive', () => {
  it('are all good with their figures', () => {
    expect(judgeDive(READY).map(({ verdict }) => verdict)).toEqual(Array(8).fill('good'));
    expect(judged({})).toMatchObject({
      Battery: ['good', '8.2 V, alarm at 6.2 V'],
      Space: ['good', '20.00 GB free'],
      Leak: ['good', 'no water, or no sensor'],
      'Without Wi-Fi': ['good', 'swims on to its end, 11:05 at most'],
    });
  });

  it.each<[Partial<DiveFacts>, string, string]>([
    [{ battery: 7.1 }, 'Battery', '7.1 V: charge it. Alarm at 6.2 V'],
    [{ left: 299 }, 'Battery', '4 min left, 12 min planned: charge it'],
    [{ wet: true }, 'Leak', 'water in the hull: open and dry it'],
    [{ weighed: false }, 'Buoyancy', 'reserve not known: weigh and trim it'],
    [{ missing: ['fins', 'imu'] }, 'Calibration', '2 steps are missing: see Bring-up'],
    [{ depth: -0.21 }, 'Depth', '−0.21 m: zero it at the surface'],
    [{ free: 4e8 }, 'Space', '400.0 MB free'],
    [{ ahead: -7200 }, 'Clock', '2:00:00 off this device’s'],
    [{ mission: { longest: 665, unwatched: 30 } }, 'Without Wi-Fi', 'ends 00:30 after the last page: limit unwatched'],
  ])('%o is to be looked at', (more, name, text) => {
    expect(judged(more)[name]).toEqual(['look', text]);
  });

  it('have the battery for the planned time, where its capacity is known', () => {
    expect(judged({ battery: 7.1, left: 725 }).Battery).toEqual(['good', '12 min left, 12 min planned']);
  });

  it('say what is not known, and leave a battery that nothing measures to a person', () => {
    const checks = judgeDive({ battery: 0.02, left: null, alarm: 6.2, missing: null, depth: null, free: null, ahead: null, wet: null, weighed: null, mission: null });
    expect(checks.map(({ name }) => name)).not.toContain('Battery');
    expect(new Set(checks.map(({ verdict }) => verdict))).toEqual(new Set(['unknown']));
  });
});
