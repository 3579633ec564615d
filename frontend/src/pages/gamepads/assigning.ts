import type { Axis } from '../../drive/axes';
import { DEAD, type Button, type Motion, type Pad, type PadProfile, type StickAxis } from '../../drive/gamepad';

/** What the next stick that is moved, or button that is pressed, is assigned to. */
export type Task = { readonly axis: Axis; readonly source: 'stick' | 'less' | 'more' } | { readonly button: Button };

/** by which an axis has to move to be meant */
const MEANT = 0.5;
/** from here on an axis at rest stands at one of its ends: a trigger */
const END = 0.9;

/** The axis that was moved farthest since `from`, towards the positive end of the motion; null while none was moved far. */
export function movedAxis(from: Pad, now: Pad): StickAxis | null {
  const ways = now.axes.map((value, index) => value - (from.axes[index] ?? 0)).map((way) => (Number.isFinite(way) ? way : 0));
  const far = Math.max(0, ...ways.map(Math.abs));
  if (far < MEANT) return null;
  const index = ways.findIndex((way) => Math.abs(way) === far);
  const stood = from.axes[index] ?? 0;
  const rest = stood <= -END ? -1 : stood >= END ? 1 : 0;
  return { index, invert: (ways[index] ?? 0) < 0, rest, dead: DEAD, curve: 0 };
}

/** The button that went down since `from`; null while none did. */
export function pressedButton(from: Pad, now: Pad): number | null {
  const index = now.buttons.findIndex(({ pressed }, place) => pressed && from.buttons[place]?.pressed !== true);
  return index < 0 ? null : index;
}

/** The profile after the task; null while nothing was moved or pressed. What had it before loses it. */
export function assigned(profile: PadProfile, task: Task, from: Pad, now: Pad): PadProfile | null {
  if ('source' in task && task.source === 'stick') {
    const stick = movedAxis(from, now);
    return stick === null ? null : withStick(profile, task.axis, stick);
  }
  const index = pressedButton(from, now);
  return index === null ? null : given(freed(profile, index), task, index);
}

/** The profile with an axis of the gamepad for one of the robot's. */
export function withStick(profile: PadProfile, axis: Axis, stick: StickAxis): PadProfile {
  const motions = profile.motions.map((motion, place) => {
    if (place === axis) return { ...motion, stick };
    return motion.stick?.index === stick.index ? { ...motion, stick: null } : motion;
  });
  return { ...profile, motions };
}

/** The profile without what the task assigns. */
export function cleared(profile: PadProfile, task: Task): PadProfile {
  return given(profile, task, null);
}

function freed({ motions, buttons }: PadProfile, index: number): PadProfile {
  const free = (button: number | null) => (button === index ? null : button);
  return {
    motions: motions.map(({ stick, less, more }) => ({ stick, less: free(less), more: free(more) })),
    buttons: Object.fromEntries(Object.entries(buttons).map(([name, button]) => [name, free(button)])) as PadProfile['buttons'],
  };
}

function given(profile: PadProfile, task: Task, index: number | null): PadProfile {
  if ('button' in task) return { ...profile, buttons: { ...profile.buttons, [task.button]: index } };
  const change = (motion: Motion): Motion => (task.source === 'stick' ? { ...motion, stick: null } : { ...motion, [task.source]: index });
  return { ...profile, motions: profile.motions.map((motion, place) => (place === task.axis ? change(motion) : motion)) };
}
