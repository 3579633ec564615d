/** Texts of the exhibit, which visitors read. */
import { pages } from './pages';

export const exhibit = {
  title: pages.exhibit,
  name: 'µ-CAT',
  what: 'A robot turtle that swims with four fins',
  views: {
    camera: 'What the turtle sees',
    bystander: 'The turtle in its simulated water',
    model: 'The turtle as its sensors feel it: a model',
    curve: 'Its depth in the last minute',
  },
  chart: 'Depth over the last minute, downwards',
  depth: 'm deep',
  replay: 'Recorded',
  now: {
    unknown: 'Waiting for the turtle',
    disarmed: 'It rests',
    checking: 'It tries its fins',
    failsafe: 'It has stopped by itself',
    manual: 'Somebody steers it',
    automatic: (depth: string) => `It holds its depth by itself, at ${depth} m`,
    alone: 'It swims by itself',
    mission: 'It carries out a mission by itself',
    dive: 'It dives',
    rise: 'It rises',
  },
  bar: 'Exhibit',
  leave: 'Leave',
  hint: 'Esc is STOP. The bar goes by itself.',
  none: 'There is no such session.',
  sessions: 'To the sessions',
} as const;
