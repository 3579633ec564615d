/** Layouts that come with the program. */
import type { ShownChart } from '../parts/panelKind';
import { layout as texts } from '../texts/layout';
import { FORMAT, VERSION, type Layout, type Placed, type Rect } from './layout';

interface Shipped {
  readonly name: string;
  readonly title: string;
  readonly layout: () => Layout;
}

const at = (panel: string, x: number, y: number, width: number, height: number, chart?: ShownChart): Placed => ({
  id: panel,
  panel,
  ...({ x, y, width, height } satisfies Rect),
  ...(chart ? { chart } : {}),
});

const layout = (...panels: Placed[]): Layout => ({ format: FORMAT, version: VERSION, panels });

const STANDARD = layout(
  at('camera', 0, 0, 17, 11),
  at('attitude', 17, 0, 7, 6),
  at('fins', 17, 6, 7, 6),
  at('robot', 17, 12, 7, 5),
  at('depth', 0, 11, 17, 6),
  at('navigation', 0, 17, 8, 7),
  at('console', 8, 17, 9, 7),
  at('events', 17, 17, 7, 7),
);

/** Where there is room for all that the robot's sensors say. */
const ROOMY = layout(
  at('camera', 0, 0, 12, 12),
  at('attitude', 12, 0, 6, 8),
  at('fins', 18, 0, 6, 8),
  at('robot', 12, 8, 6, 5),
  at('imu', 18, 8, 6, 5),
  at('depth', 0, 12, 12, 6),
  at('beacons', 12, 13, 6, 5),
  at('link', 18, 13, 6, 5),
  at('navigation', 0, 18, 8, 6),
  at('console', 8, 18, 9, 6),
  at('events', 17, 18, 7, 6),
);

const SENSORS = layout(
  at('attitude', 0, 0, 6, 8),
  at('imu', 6, 0, 9, 8),
  at('beacons', 15, 0, 9, 5),
  at('battery', 15, 5, 9, 6),
  at('depth', 0, 8, 15, 9),
  at('link', 15, 11, 9, 8),
  at('console', 0, 17, 15, 7),
  at('events', 15, 19, 9, 5),
);

/** px: from here on the roomy one is standard */
const ROOMY_FROM = 1900;

export const SHIPPED: readonly Shipped[] = [
  { name: 'standard', title: texts.shipped.standard, layout: () => (window.innerWidth >= ROOMY_FROM ? ROOMY : STANDARD) },
  { name: 'sensors', title: texts.shipped.sensors, layout: () => SENSORS },
];
