/** Texts of the flight view. */
import { pages } from './pages';

export const flight = {
  title: pages.flight,
  instruments: (depth: string, heading: string, roll: string, pitch: string) =>
    `Depth ${depth} m, heading ${heading}°, roll ${roll}°, pitch ${pitch}°`,
  depth: 'depth',
  attitude: 'attitude',
  old: (what: string, age: string) => `${what} ${age} old`,
  none: (what: string) => `no ${what} yet`,
  picture: {
    none: 'No picture yet',
    age: (age: string) => `picture ${age}`,
  },
  views: { camera: 'camera', bystander: 'bystander', model: 'model' },
  modelHint: 'Drawn from the measured depth, attitude and fins',
  swap: (view: string) => `Swap: show the ${view} large`,
  tools: 'Flight view',
  leave: 'Leave',
  leaveHint: 'Leave the flight view (V; F where it does not drive). Esc is STOP.',
  fullScreen: 'Full screen',
  fullScreenHint: 'Fill the screen. Leaving it by Esc is STOP as well.',
  fullScreenNone: 'This browser has no full screen for pages.',
  fullScreenDenied: 'The browser refused the full screen.',
  controls: 'Controls',
  charts: 'Charts and console',
  alarms: { more: (count: number) => `and ${count} more` },
  note: 'note',
  close: (what: string) => `Close ${what}`,
  dark: {
    insecure: 'The screen may go dark: browsers keep it on only over https or on the robot’s own computer.',
    none: 'The screen may go dark: this browser cannot keep it on.',
    denied: 'The screen may go dark: the browser refused to keep it on, perhaps to save its battery.',
  },
  speed: (step: number) => `speed ${step}`,
} as const;
