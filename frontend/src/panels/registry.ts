import Camera from './camera/Camera.svelte';
import Console from './console/Console.svelte';
import DepthChart from './depth/DepthChart.svelte';
import Events from './events/Events.svelte';
import Fins from './fins/Fins.svelte';
import Horizon from './attitude/Horizon.svelte';
import Navigation from './navigation/Navigation.svelte';
import { ownTitle, type PanelKind, type Plain, type Size } from '../parts/panelKind';

/** What an operator looks at first comes with the page, the others when they are first shown. */
const here = (component: Plain) => () => Promise.resolve({ default: component });

/** Every panel that comes with the program, but for charts, of which there may be several (docs/use/panels.md). */
export const PANELS: readonly PanelKind[] = [
  {
    name: 'camera',
    title: 'Camera',
    about: 'The picture with what is found in it',
    load: here(Camera),
    size: { width: 17, height: 11 },
    least: { width: 9, height: 8 },
  },
  {
    name: 'depth',
    title: 'Depth over time',
    about: 'Depth and set point, events as flags',
    load: here(DepthChart),
    size: { width: 17, height: 6 },
    least: { width: 10, height: 5 },
  },
  {
    name: 'attitude',
    title: 'Attitude',
    about: 'The artificial horizon',
    load: here(Horizon),
    size: { width: 7, height: 6 },
    least: { width: 5, height: 5 },
    tab: 'motion',
  },
  {
    name: 'fins',
    title: 'Fins',
    about: 'Angles, commanded and measured, and the drive of the motors',
    load: here(Fins),
    size: { width: 7, height: 6 },
    least: { width: 6, height: 6 },
    tab: 'motion',
  },
  {
    name: 'robot',
    title: 'Robot',
    about: 'The robot in space, its fins as the encoders say',
    load: () => import('./robot/Robot3d.svelte'),
    size: { width: 7, height: 6 },
    least: { width: 5, height: 5 },
    tab: 'motion',
  },
  {
    name: 'navigation',
    title: 'Navigation command',
    about: 'What the controller or the pilot asks of the fins',
    load: here(Navigation),
    size: { width: 8, height: 7 },
    least: { width: 7, height: 5 },
    tab: 'motion',
  },
  {
    name: 'imu',
    title: 'Inertial sensor',
    about: 'Roll, pitch and yaw, turn rates, specific forces',
    load: () => import('./imu/Imu.svelte'),
    size: { width: 8, height: 8 },
    least: { width: 6, height: 5 },
    tab: 'sensors',
  },
  {
    name: 'beacons',
    title: 'Light beacons',
    about: 'Which detector sees the beacon, now and before',
    load: () => import('./beacons/Beacons.svelte'),
    size: { width: 8, height: 5 },
    least: { width: 6, height: 4 },
    tab: 'sensors',
  },
  {
    name: 'battery',
    title: 'Battery',
    about: 'Voltage, and how long until its alarm',
    load: () => import('./battery/Battery.svelte'),
    size: { width: 6, height: 6 },
    least: { width: 5, height: 4 },
    tab: 'sensors',
  },
  {
    name: 'link',
    title: 'Serial link',
    about: 'Round trip, losses and repeats between computer and board',
    load: () => import('./link/Link.svelte'),
    size: { width: 8, height: 7 },
    least: { width: 6, height: 5 },
    tab: 'sensors',
  },
  {
    name: 'console',
    title: 'Console',
    about: 'What the firmware prints, with a filter',
    load: here(Console),
    size: { width: 9, height: 7 },
    least: { width: 8, height: 4 },
    tab: 'console',
  },
  {
    name: 'events',
    title: 'Events',
    about: 'What has happened, in words',
    load: here(Events),
    size: { width: 7, height: 7 },
    least: { width: 5, height: 4 },
    tab: 'events',
  },
];

export const CHART = 'chart';
export const OWN = 'own/';
export const loadChart = () => import('./chart/PlacedChart.svelte');
export const loadOwn = () => import('./own/OwnPanel.svelte');

const CHART_KIND = { title: 'Chart', size: { width: 12, height: 7 }, least: { width: 7, height: 5 } };
const OWN_SIZE = { size: { width: 8, height: 7 }, least: { width: 4, height: 3 } };

/** What a layout's panel is called and how large it is; an unknown one can be moved and removed as well. */
export function describe(panel: string): { readonly title: string; readonly size: Size; readonly least: Size } {
  if (panel === CHART) return CHART_KIND;
  if (panel.startsWith(OWN)) return { title: ownTitle(panel.slice(OWN.length)), ...OWN_SIZE };
  return PANELS.find(({ name }) => name === panel) ?? { title: `Unknown panel “${panel}”`, ...OWN_SIZE };
}
