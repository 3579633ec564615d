/** Texts of the page that signs a browser in. */
export const signIn = {
  title: 'Sign in',
  heading: (robot: string) => `Sign in to ${robot}`,
  byLink: 'Your link is a key to this robot. Give this browser a name, and sign in.',
  code: 'Pairing code',
  name: 'Name of this browser',
  nameHint: 'Others see this name, for example when this browser has control.',
  submit: 'Sign in',
  submitting: 'Signing in…',
  help: {
    title: 'No code?',
    ask: 'Ask an operator for a link. Operators create links under System, People.',
    run: 'On the robot’s computer, run',
    printed: 'It prints a link, a code and a QR code, valid for ten minutes.',
  },
} as const;
