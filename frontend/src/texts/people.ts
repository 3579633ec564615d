/** Texts of the page People. */
import { access } from './access';
import { pages } from './pages';

const ROLES = access.roles;
type Role = keyof typeof ROLES;

export const people = {
  title: pages.people,
  about: 'Browsers and programs that can use this robot.',
  back: '← System',
  roles: ROLES,
  roleChoice: {
    legend: 'Role',
    about: { viewer: 'can watch and press STOP', operator: 'can also control the robot and invite others' },
  },
  scopes: { read: 'read', operate: 'operate', administer: 'administer' },
  scopeChoice: {
    legend: 'Scope',
    about: {
      read: 'can watch and press STOP',
      operate: 'can also control the robot, change settings and record',
      administer: 'can also invite others, make tokens and take backups',
    },
  },
  you: {
    title: 'You',
    can: {
      viewer: 'You can watch everything, open recordings, and press STOP at any time.',
      operator: 'You can control and arm the robot, drive, change settings, record, and invite others.',
    },
    cannot: {
      viewer: 'You cannot control the robot, change settings, record, or invite others. An operator can change your role.',
      operator: '',
    },
    signOut: 'Sign out',
  },
  devices: {
    title: 'Browsers and programs',
    role: 'Role or scope',
    lastSeen: 'Last seen',
    actions: 'Change or revoke',
    thisOne: 'this browser',
    since: (kind: string, time: string) => `${kind}, since ${time}`,
    ends: (time: string) => `ends on ${time}`,
    revokeSelf: 'You will be signed out here.',
    revokeOther: 'Signs it out at once. It needs a new code to sign in again.',
    revoke: 'Revoke',
    revokeAsk: 'Revoke…',
    revokeNamed: (name: string) => `Revoke ${name}`,
    make: (role: Role) => `Make ${ROLES[role]}`,
    makeNamed: (role: Role, name: string) => `Make ${ROLES[role]}: ${name}`,
  },
  invite: {
    title: 'Invite',
    qrCode: 'QR code of the link',
    signsInAs: 'This link signs one browser in as',
    once: 'It works once.',
    link: 'Link',
    code: 'Code',
    validFor: 'valid for',
    create: 'Create link',
    expired: 'The link has expired. Create another one.',
  },
  tokens: {
    title: 'Token for a program',
    tokenOf: 'Token of',
    copyNow: 'Copy it now. It is not shown again.',
    token: 'Token',
    sendAs: 'The program sends it as',
    programName: 'Name of the program',
    programExample: 'depth logger',
    ends: 'Ends',
    never: 'never',
    afterDays: (days: number) => `after ${String(days)} days`,
    create: 'Create token',
  },
  audit: {
    title: 'Audit log',
    about: 'Who did what when. Nobody can change it here.',
    who: 'Who',
    whoExample: 'name, role or address',
    what: 'What',
    whatExample: 'action, detail or outcome',
    since: 'From',
    until: 'To',
    when: 'When',
    outcome: 'Outcome',
    show: 'Show',
    file: 'CSV file',
    nobody: 'not signed in',
    outcomes: { done: 'done', refused: 'refused', failed: 'failed', begun: 'begun' },
    times: (count: number) => `${String(count)} times`,
    none: 'Nothing fits.',
    more: 'Only the newest 200 entries are shown. Narrow the time, or take the CSV file.',
  },
} as const;
