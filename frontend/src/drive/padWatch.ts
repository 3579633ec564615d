/** The gamepad that drives: looked at fifty times a second, fetched when the first one is there. */
import { gamepads as texts } from '../texts/gamepads';
import { holdPage } from './backGuard';
import { shortName, type Button, type PadProfile } from './gamepad';
import { PadReader, SILENT_NOTICE, SILENT_RELEASE, type PadLook } from './padReader';
import { profileOf, storedChoice } from './padProfiles';
import type { Pilot } from './pilot.svelte';

/** ms between two looks */
const LOOK = 20;
export const SOURCE = 'gamepad';

export interface PadNews {
  readonly name: string | null;
  readonly notice: string;
  readonly waits: boolean;
  readonly profile: PadProfile | null;
  readonly index: number | null;
}

/**
 * Let a gamepad drive. Returns what ends it.
 *
 * @param tell called with each look
 * @param press a button went down; one that is down when the gamepad is first seen did not
 */
export function watchPads(pilot: Pilot, press: (button: Button) => void, tell: (news: PadNews) => void): () => void {
  const profiles = new Map<string, PadProfile | null>();
  const reader = new PadReader((pad) => {
    const known = profiles.get(pad.id) ?? profileOf(pad);
    profiles.set(pad.id, known);
    return known;
  }, storedChoice);
  const guard = holdPage();
  let gone = '';

  function look(): void {
    const seen = reader.look(navigator.getGamepads(), performance.now() / 1000, pilot.steers);
    if (seen.gone !== null) gone = texts.disconnected(shortName(seen.gone) || texts.unnamed);
    else if (seen.joined || seen.pushes.length > 0) gone = '';
    pilot.hold(SOURCE, seen.pushes);
    if (seen.pad?.buttons.some(({ pressed }) => pressed)) guard.pressed();
    for (const button of seen.pressed) press(button);
    tell({
      name: seen.pad === null ? null : shortName(seen.pad.id) || texts.unnamed,
      notice: noticeOf(seen) || gone,
      waits: seen.waits,
      profile: seen.profile,
      index: seen.pad?.index ?? null,
    });
  }

  look();
  const looking = setInterval(look, LOOK);
  window.addEventListener('gamepaddisconnected', look);
  return () => {
    clearInterval(looking);
    window.removeEventListener('gamepaddisconnected', look);
    guard.end();
    pilot.hold(SOURCE, []);
  };
}

/** What there is to tell about it; '' where there is nothing. */
export function noticeOf(seen: PadLook): string {
  const { pad, silence, waits, offRest, unassigned } = seen;
  if (pad === null) return unassigned === null ? '' : texts.unassigned(shortName(unassigned.id) || texts.unnamed);
  if (silence >= SILENT_RELEASE) return texts.released(SILENT_RELEASE);
  if (waits) return texts.release(offRest.map(({ axis, value }) => texts.stands(texts.motions[axis].name, value)));
  return silence >= SILENT_NOTICE ? texts.silent(Math.floor(silence), SILENT_RELEASE) : '';
}
