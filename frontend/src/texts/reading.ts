/** Texts of links: the address of what is seen, and reading links. */
export const reading = {
  name: 'µ-CAT',
  youRead: (session: string, ends: string) => `You are reading session ${session}${ends === '' ? '' : ` until ${ends}`}.`,
  elsewhere: {
    title: 'Not in this link',
    text: 'A reading link shows one session and its replay. To see more, ask an operator for a link to sign in with.',
    open: 'Open the session',
  },
} as const;
/** Texts of the shell's part that gives others what is seen. */
export const share = {
  title: 'Share this view',
  link: 'Link to this view',
  who: 'Opens for everybody who is signed in at this robot.',
  localhost: 'This link opens on this computer only. Open the page under the robot’s own address to copy one for others.',
  readers: {
    title: 'Reading link',
    about: (session: string) => `Shows session ${session} and its replay to anybody who has the link, without a sign-in and without control.`,
    ends: 'Ends',
    choices: { day: 'in 1 day', week: 'in 1 week', date: 'on a date' },
    date: 'Last day',
    make: 'Make reading link',
    made: 'Copy it now: it is shown only this once.',
    link: 'Reading link',
    list: 'Reading links of this session',
    until: (moment: string) => `until ${moment}`,
    used: (moment: string | null) => (moment === null ? 'not opened yet' : `last used ${moment}`),
    end: 'End',
    endOf: (moment: string) => `End the link made ${moment}`,
  },
} as const;
