import { describe, expect, it } from 'vitest';
import { moved, turned, VIEWS } from '../src/panels/camera/view';

describe('the bystander’s view', () => {
  it('turns all the way round', () => {
    expect(turned(VIEWS.side, 100, 0).azimuth).toBe(-170);
    expect(turned(VIEWS.follow, -172, 0).azimuth).toBe(160);
  });

  it('stops short of upright, above and below', () => {
    expect(turned(VIEWS.side, 0, 200).elevation).toBe(89);
    expect(turned(VIEWS.side, 0, -200).elevation).toBe(-60);
  });

  it('stays near and outside the robot', () => {
    expect(moved(VIEWS.follow, 100).distance).toBe(15);
    expect(moved(VIEWS.follow, 0.01).distance).toBe(0.4);
    expect(moved(VIEWS.follow, 2)).toEqual({ ...VIEWS.follow, distance: 2.2 });
  });
});
