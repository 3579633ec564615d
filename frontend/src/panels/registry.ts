import Camera from './camera/Camera.svelte';
import Console from './console/Console.svelte';
import DepthChart from './depth/DepthChart.svelte';
import Events from './events/Events.svelte';
import Fins from './fins/Fins.svelte';
import Horizon from './attitude/Horizon.svelte';
import Navigation from './navigation/Navigation.svelte';
import { ownTitle, type PanelKind, type Plain, type Size } from '../parts/panelKind';
import { missionRun } from '../texts/mission_run';
import { panels as texts } from '../texts/panels';

/** Panels that an operator looks at first come with the page, the others when they are first shown. */
const here = (component: Plain) => () => Promise.resolve({ default: component });

export const loadMission = () => import('./mission/Mission.svelte');

/** Every panel that comes with the program, but for charts, of which there may be several (docs/use/panels.md). */
export const PANELS: readonly PanelKind[] = [
  {
    name: 'camera',
    title: texts.titles.camera,
    about: texts.about.camera,
    load: here(Camera),
    size: { width: 17, height: 11 },
    least: { width: 9, height: 8 },
  },
  {
    name: 'depth',
    title: texts.titles.depth,
    about: texts.about.depth,
    load: here(DepthChart),
    size: { width: 17, height: 6 },
    least: { width: 10, height: 5 },
  },
  {
    name: 'attitude',
    title: texts.titles.attitude,
    about: texts.about.attitude,
    load: here(Horizon),
    size: { width: 7, height: 6 },
    least: { width: 5, height: 5 },
    tab: 'motion',
  },
  {
    name: 'fins',
    title: texts.titles.fins,
    about: texts.about.fins,
    load: here(Fins),
    size: { width: 7, height: 6 },
    least: { width: 6, height: 6 },
    tab: 'motion',
  },
  {
    name: 'robot',
    title: texts.titles.robot,
    about: texts.about.robot,
    load: () => import('./robot/Robot3d.svelte'),
    size: { width: 7, height: 6 },
    least: { width: 5, height: 5 },
    tab: 'motion',
  },
  {
    name: 'navigation',
    title: texts.titles.navigation,
    about: texts.about.navigation,
    load: here(Navigation),
    size: { width: 8, height: 7 },
    least: { width: 7, height: 5 },
    tab: 'motion',
  },
  {
    name: 'imu',
    title: texts.titles.imu,
    about: texts.about.imu,
    load: () => import('./imu/Imu.svelte'),
    size: { width: 8, height: 8 },
    least: { width: 6, height: 5 },
    tab: 'sensors',
  },
  {
    name: 'beacons',
    title: texts.titles.beacons,
    about: texts.about.beacons,
    load: () => import('./beacons/Beacons.svelte'),
    size: { width: 8, height: 5 },
    least: { width: 6, height: 4 },
    tab: 'sensors',
  },
  {
    name: 'battery',
    title: texts.titles.battery,
    about: texts.about.battery,
    load: () => import('./battery/Battery.svelte'),
    size: { width: 6, height: 6 },
    least: { width: 5, height: 4 },
    tab: 'sensors',
  },
  {
    name: 'link',
    title: texts.titles.link,
    about: texts.about.link,
    load: () => import('./link/Link.svelte'),
    size: { width: 8, height: 7 },
    least: { width: 6, height: 5 },
    tab: 'sensors',
  },
  {
    name: 'console',
    title: texts.titles.console,
    about: texts.about.console,
    load: here(Console),
    size: { width: 9, height: 7 },
    least: { width: 8, height: 4 },
    tab: 'console',
  },
  {
    name: 'events',
    title: texts.titles.events,
    about: texts.about.events,
    load: here(Events),
    size: { width: 7, height: 7 },
    least: { width: 5, height: 4 },
    tab: 'events',
  },
  {
    name: 'mission',
    title: missionRun.title,
    about: missionRun.about,
    load: loadMission,
    size: { width: 8, height: 10 },
    least: { width: 6, height: 6 },
  },
];

export const CHART = 'chart';
export const OWN = 'own/';
export const loadChart = () => import('./chart/PlacedChart.svelte');
export const loadOwn = () => import('./own/OwnPanel.svelte');

const CHART_KIND = { title: texts.titles.chart, size: { width: 12, height: 7 }, least: { width: 7, height: 5 } };
const OWN_SIZE = { size: { width: 8, height: 7 }, least: { width: 4, height: 3 } };

/** Title and size of a layout's panel; an unknown one can be moved and removed as well. */
export function describe(panel: string): { readonly title: string; readonly size: Size; readonly least: Size } {
  if (panel === CHART) return CHART_KIND;
  if (panel.startsWith(OWN)) return { title: ownTitle(panel.slice(OWN.length)), ...OWN_SIZE };
  return PANELS.find(({ name }) => name === panel) ?? { title: texts.titles.unknown(panel), ...OWN_SIZE };
}
