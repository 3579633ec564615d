/** Assignments of gamepads in this browser, and as files. */
import { readStored, readStoredJson, writeStored } from '../storage';
import { gamepads as texts } from '../texts/gamepads';
import { BUTTONS, DEAD_MOST, STANDARD, type Motion, type PadProfile, type StickAxis } from './gamepad';
import type { SeenPad } from './padReader';

const KEY = 'mucat-gamepads';
const CHOICE = 'mucat-gamepad';
const FORMAT = 'mucat-gamepad';
const VERSION = 1;
/** axes and buttons of a gamepad, in the browser that has most */
const INDEX_MOST = 127;

class Refused extends Error {}

function require(good: boolean, problem: string): asserts good {
  if (!good) throw new Refused(problem);
}

const isObject = (value: unknown): value is Record<string, unknown> => typeof value === 'object' && value !== null && !Array.isArray(value);

function readIndex(value: unknown, what: string): number | null {
  if (value === null || value === undefined) return null;
  require(Number.isInteger(value) && (value as number) >= 0 && (value as number) <= INDEX_MOST, texts.file.index(what, INDEX_MOST));
  return value as number;
}

function readShare(value: unknown, most: number, what: string): number {
  require(typeof value === 'number' && value >= 0 && value <= most, texts.file.share(what, most));
  return value;
}

function readStick(value: unknown, name: string): StickAxis | null {
  if (value === null || value === undefined) return null;
  require(isObject(value), texts.file.stick(name));
  const index = readIndex(value.index, name);
  require(index !== null, texts.file.stick(name));
  require(typeof value.invert === 'boolean' && [-1, 0, 1].includes(value.rest as number), texts.file.stick(name));
  return {
    index,
    invert: value.invert,
    rest: value.rest as StickAxis['rest'],
    dead: readShare(value.dead, DEAD_MOST, texts.file.dead(name)),
    curve: readShare(value.curve, 1, texts.file.curve(name)),
  };
}

/** The assignments in a value that JSON gave. Raises Refused, with the reason in words. */
function readProfile(value: unknown): PadProfile {
  require(isObject(value) && Array.isArray(value.motions) && isObject(value.buttons), texts.file.incomplete);
  const { motions, buttons } = value;
  require(motions.length === STANDARD.motions.length, texts.file.motions(STANDARD.motions.length));
  const unknown = Object.keys(buttons).find((name) => !(BUTTONS as readonly string[]).includes(name));
  require(unknown === undefined, texts.file.action(unknown ?? ''));
  const profile = {
    motions: motions.map((motion: unknown, axis): Motion => {
      const name = texts.motions[axis]?.name ?? '';
      require(isObject(motion), texts.file.stick(name));
      return { stick: readStick(motion.stick, name), less: readIndex(motion.less, name), more: readIndex(motion.more, name) };
    }),
    buttons: Object.fromEntries(BUTTONS.map((name) => [name, readIndex(buttons[name], texts.actions[name])])) as PadProfile['buttons'],
  };
  const used = [...profile.motions.flatMap(({ less, more }) => [less, more]), ...Object.values(profile.buttons)].filter((one) => one !== null);
  const twice = used.find((one, place) => used.indexOf(one) !== place);
  require(twice === undefined, texts.file.twice(twice ?? 0));
  return profile;
}

export const fileOf = (id: string, profile: PadProfile): string => `${JSON.stringify({ format: FORMAT, version: VERSION, gamepad: id, ...profile }, null, 2)}\n`;

/** The gamepad and its assignments in a file's text, or why it cannot be used. */
export function readPadFile(text: string): { readonly id: string; readonly profile: PadProfile } | { readonly problem: string } {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    return { problem: texts.file.noJson };
  }
  try {
    require(isObject(value) && value.format === FORMAT, texts.file.other);
    require(value.version === VERSION, texts.file.version);
    return { id: typeof value.gamepad === 'string' ? value.gamepad : '', profile: readProfile(value) };
  } catch (error) {
    if (error instanceof Refused) return { problem: error.message };
    throw error;
  }
}

function storedProfiles(): Record<string, unknown> {
  const stored = readStoredJson(KEY);
  return isObject(stored) ? stored : {};
}

/** Assignments of this gamepad: those that are stored for its id, or the usual ones of the standard layout, or none. */
export function profileOf({ id, mapping }: Pick<SeenPad, 'id' | 'mapping'>): PadProfile | null {
  const usual = mapping === 'standard' ? STANDARD : null;
  const stored = storedProfiles();
  if (!Object.hasOwn(stored, id)) return usual;
  try {
    return readProfile(stored[id]);
  } catch {
    // Another version wrote it.
    return usual;
  }
}

/** @param profile null: the usual ones again */
export function storeProfile(id: string, profile: PadProfile | null): void {
  const others = Object.entries(storedProfiles()).filter(([other]) => other !== id);
  writeStored(KEY, JSON.stringify(Object.fromEntries(profile === null ? others : [...others, [id, profile]])));
}

/** The key of the gamepad that shall drive; null: the one that is moved. */
export function storedChoice(): string | null {
  const stored = readStored(CHOICE);
  return stored === '' ? null : stored;
}

export const storeChoice = (key: string | null): void => writeStored(CHOICE, key ?? '');
