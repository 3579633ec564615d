/** Texts of the page's sounds: in the page's settings, and spoken. */
export const sound = {
  title: 'Sound',
  volumes: { off: 'Off', low: 'Low', full: 'Full' },
  spoken: 'Spoken words',
  hint: 'Tones for armed, disarmed, alarm, lost link, low battery and the end of a mission.',
  vibrates: 'A phone also vibrates at armed and alarm.',
  testWords: 'Sound is on',
  noAudio: 'This browser plays no tones.',
  noSpeech: 'This browser has no voice.',
  silenced: 'The browser keeps this page silent until you press something on it.',
  words: {
    armed: 'Armed',
    disarmed: 'Disarmed',
    lost: 'Connection lost',
    battery: 'Battery low',
    mission: (title: string, phase: string) => `Mission ${title} ${phase}`,
    alarm: (what: string) => `Alarm. ${what}`,
  },
} as const;
