import type { Rows } from '../generated/topics';

export type Timed = keyof Rows | 'state' | 'detection' | 'picture' | 'camera' | 'observer' | 'mask';

/** s between two samples of each topic on a fast line; `state.paces` says what a slow one carries. */
export const PERIODS: Record<keyof Rows | 'state', number> = {
  imu: 0.01,
  depth: 0.02,
  beacon: 0.1,
  motor: 0.02,
  status: 0.1,
  navigation: 0.1,
  control: 0.1,
  turning: 0.1,
  track: 0.1,
  link: 1,
  truth: 0.05,
  state: 1,
};

/**
 * Most rows a second where that is more than a row each period: control.rate is at most 50 Hz, and by hand each of the
 * pilot's 20 inputs a second is a row beside the ticks.
 */
export const RATES_MOST: Partial<Record<keyof Rows, number>> = { control: 50, turning: 50, track: 50, navigation: 70 };

/** s between two pictures of the bystander (robot_runtime/simulation/scene/process.py) */
export const OBSERVER_PERIOD = 1 / 12;

/** s between two pictures of a recording: its thumbnails */
export const THUMBNAIL_PERIOD = 2;

/** s that charts show at most, and that the server keeps */
export const HISTORY_SHOWN = 600;

/** s that the rings hold: a little more, since no clock is exact. */
export const HISTORY = 615;
