import { PITCH, ROLL, X, Y, YAW, Z, type Push } from './axes';

/** The part of a gamepad, in the "standard" layout of the Gamepad API, that is read. */
export type Pad = Pick<Gamepad, 'axes' | 'buttons'>;

/** share of the way from the middle within which a stick that nobody touches may stand */
const DEAD = 0.15;
/** The buttons, by their number in the standard layout. */
export const BUTTONS = { stop: 1, depth: 2, heading: 3, slower: 4, faster: 5 } as const;
export type Button = keyof typeof BUTTONS;
const CROSS: readonly (readonly [button: number, push: Push])[] = [
  [12, { axis: PITCH, amount: 1 }],
  [13, { axis: PITCH, amount: -1 }],
  [14, { axis: ROLL, amount: -1 }],
  [15, { axis: ROLL, amount: 1 }],
];

/** A stick from rest at 0 to its end at 1, whatever its direction; both in -1 to 1. */
function beyondDead(right: number, down: number): [right: number, down: number] {
  const far = Math.hypot(right, down);
  if (!(far > DEAD)) return [0, 0];
  const share = Math.min(1, (far - DEAD) / (1 - DEAD)) / far;
  return [right * share, down * share];
}

/** Pushes of its sticks and its directional pad; none where every stick rests. As on the screen: the left stick lifts and turns. */
export function pushesOf({ axes, buttons }: Pad): Push[] {
  const [leftX = 0, leftY = 0, rightX = 0, rightY = 0] = axes;
  const [turn, down] = beyondDead(leftX, leftY);
  const [right, back] = beyondDead(rightX, rightY);
  const sticks: Push[] = [
    { axis: X, amount: -back },
    { axis: Y, amount: right },
    { axis: Z, amount: down },
    { axis: YAW, amount: turn },
  ];
  const cross = CROSS.filter(([button]) => buttons[button]?.pressed).map(([, push]) => push);
  return [...sticks.filter(({ amount }) => amount !== 0), ...cross];
}

export const pressed = ({ buttons }: Pad, button: Button): boolean => buttons[BUTTONS[button]]?.pressed ?? false;
