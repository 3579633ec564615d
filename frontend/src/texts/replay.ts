/** Texts of a replay. */
import { pages } from './pages';

export const replay = {
  title: pages.replay,
  noSession: 'No session at this address.',
  sessions: 'Go to Sessions',
  refused: 'This is a replay. Commands are not possible here. Exit the replay first.',
  of: 'of',
  states: 'State of the robot in the recording',
  exit: 'Exit',
  exitLong: 'replay',
  player: {
    label: 'Player',
    hole: (start: string, end: string) => `No recording from ${start} to ${end}.`,
    leftOut: (count: string) => `${count} samples near this time cannot be shown: they are damaged or of another version.`,
    previousBookmark: 'Previous bookmark',
    nextBookmark: 'Next bookmark',
    back: (seconds: number) => `Back ${seconds} s`,
    backHint: (seconds: number) => `Back ${seconds} s (←), 30 s with shift`,
    forward: (seconds: number) => `Forward ${seconds} s`,
    forwardHint: (seconds: number) => `Forward ${seconds} s (→), 30 s with shift`,
    play: 'Play',
    pause: 'Pause',
    spaceKey: (action: string) => `${action} (space)`,
    localTime: 'Local time of the recording',
    speed: 'Speed',
  },
  seek: {
    hole: 'No recording',
    hint: (near: number, far: number) => `Arrow keys move by ${near} s, with shift by ${far} s. Press or drag to seek.`,
    position: 'Time since the start of the session',
    positionOf: (position: string, duration: string) => `${position} of ${duration}`,
    bookmark: (text: string) => `Bookmark ${text}`,
  },
  mark: {
    button: 'Mark',
    hint: 'Add a note at this moment',
  },
} as const;
