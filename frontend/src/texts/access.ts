/** Texts about who uses the page, and with which rights. */
export const access = {
  roles: { viewer: 'viewer', operator: 'operator' },
  silent: 'The server does not answer. This page keeps trying.',
  signedOut: 'You have signed out.',
  noLongerSignedIn: 'This browser is no longer signed in.',
  operatorOnly: 'Viewers can watch and press STOP. This needs an operator.',
  readerOnly: 'A reading link shows the session, and changes nothing.',
  confirmation: {
    heading: 'Confirmation needed',
    about: 'This changes who may use the robot, or takes its data. Enter a new operator code; it counts for 10 minutes.',
    ask: 'Another operator creates one under System, People.',
    run: 'On the robot’s computer, run',
    code: 'Operator code or link',
    submit: 'Confirm',
    submitting: 'Confirming…',
  },
  browser: 'Browser',
  browserOn: (browser: string, system: string) => `${browser} on ${system}`,
} as const;
