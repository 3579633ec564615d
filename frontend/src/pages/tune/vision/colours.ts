import type { ColourRange, VisionSettings } from '../../../api';
import { vision as texts } from '../../../texts/vision';

/** OpenCV halves the colour circle's degrees. */
export const HUES = 180;
export const BYTE_MAX = 255;

/** How wide a hue range is, through 0 where it runs so. */
export function hueSpan({ hue: [low, high] }: ColourRange): number {
  return (high - low + HUES) % HUES;
}

/** CSS of a colour in OpenCV's numbers. */
export function css(hue: number, saturation: number, value: number): string {
  const v = value / BYTE_MAX;
  const s = saturation / BYTE_MAX;
  const lightness = v * (1 - s / 2);
  const within = Math.min(lightness, 1 - lightness);
  const chroma = within === 0 ? 0 : (v - lightness) / within;
  return `hsl(${(hue % HUES) * 2} ${(100 * chroma).toFixed(1)}% ${(100 * lightness).toFixed(1)}%)`;
}

/** share of the picture from which on a mask tells nothing apart */
const ALL = 0.95;

/** Whether a colour covers so much of the picture (a share) that it tells nothing apart. */
export const coversAll = (share: number): boolean => share >= ALL;

/** The JPEG file of these characters in base64. */
export function jpegOf(base64: string): Blob {
  return new Blob([Uint8Array.from(atob(base64), (character) => character.charCodeAt(0))], { type: 'image/jpeg' });
}

/** The colour in the middle of a range, as CSS. */
export function middle(range: ColourRange): string {
  const { hue, saturation, value } = range;
  return css(hue[0] + hueSpan(range) / 2, (saturation[0] + saturation[1]) / 2, (value[0] + value[1]) / 2);
}

/** A name that no colour has yet. */
export function freeName(colours: VisionSettings['colours']): string {
  let number = 1;
  while (texts.colours.newName(number) in colours) number += 1;
  return texts.colours.newName(number);
}

/** Why a colour cannot be named so, in words; empty where it can. */
export function nameProblem(name: string, colours: VisionSettings['colours'], own = ''): string {
  if (!/^\p{L}[\p{L}\p{N}_ .-]{0,31}$/u.test(name)) return texts.colours.invalidName;
  if (/^marker \d+$/.test(name)) return texts.colours.markerName;
  if (name !== own && name in colours) return texts.colours.nameTaken;
  return '';
}

/** The settings with a colour under another name, in its old place. */
export function renamed(settings: VisionSettings, from: string, to: string): Partial<VisionSettings> {
  const move = <T>(entries: Record<string, T>): Record<string, T> =>
    Object.fromEntries(Object.entries(entries).map(([name, one]) => [name === from ? to : name, one]));
  return {
    colours: move(settings.colours),
    actions: move(settings.actions),
    colour: settings.colour === from ? to : settings.colour,
  };
}

/** The settings without a colour; never without the wanted one. */
export function without(settings: VisionSettings, name: string): Partial<VisionSettings> {
  const rest = <T>(entries: Record<string, T>): Record<string, T> =>
    Object.fromEntries(Object.entries(entries).filter(([one]) => one !== name));
  return { colours: rest(settings.colours), actions: rest(settings.actions) };
}
