/** Names of the pages: in the tabs, in headings and in the title of the window. */
export const pages = {
  operate: 'Operate',
  flight: 'Flight view',
  exhibit: 'Exhibit',
  tune: 'Tune',
  missions: 'Missions',
  scenarios: 'Scenarios',
  'comm-tests': 'Comm tests',
  sessions: 'Sessions',
  robots: 'Robots',
  figures: 'Figures',
  system: 'System',
  gamepads: 'Gamepads',
  replay: 'Replay',
  people: 'People',
  'bring-up': 'Bring-up',
  unknown: 'Page not found',
} as const;
