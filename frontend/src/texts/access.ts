/** Texts about who uses the page, and with which rights. */
export const access = {
  roles: { viewer: 'viewer', operator: 'operator' },
  silent: 'The server does not answer. This page keeps trying.',
  signedOut: 'You have signed out.',
  noLongerSignedIn: 'This browser is no longer signed in.',
  operatorOnly: 'Viewers can watch and press STOP. This needs an operator.',
  browser: 'Browser',
  browserOn: (browser: string, system: string) => `${browser} on ${system}`,
} as const;
