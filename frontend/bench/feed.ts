/** What both measured pages show, fed by the same socket as the page itself. */
import { LiveFeed } from '../src/live/feed';

export const NAMES = ['imu.rate', 'imu.force', 'motor.angle', 'imu.attitude'].flatMap((field) =>
  [0, 1, 2].map((element) => `${field}_${element}`),
);
/** s that the charts span; a minute where the address says nothing else */
export const SECONDS = Number(new URLSearchParams(location.search).get('seconds') ?? 60);

export function startFeed(): LiveFeed {
  const nobody = { know: () => undefined, check: () => Promise.resolve(true), lab: false };
  const feed = new LiveFeed(`ws://${location.host}/api/live`, nobody);
  feed.start();
  return feed;
}

/** The element in which charts are drawn. */
export function place(): HTMLElement {
  const found = document.getElementById('page');
  if (found === null) throw new Error('no element "page"');
  return found;
}
