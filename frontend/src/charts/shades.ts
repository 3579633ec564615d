/** Colours between others, each with an ink that can be read on it. */
import type { Paint } from '../parts/table';

type Rgb = readonly [number, number, number];

/** With black and white one of the two always reaches a contrast of 4.5:1. */
const INK_DARK = '#000000';
const INK_LIGHT = '#ffffff';

/** The colour at a share, 0 to 1, of the way through these, which are hex and evenly spaced. */
export function mixedPaint(stops: readonly string[], share: number): Paint {
  const at = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  const [from, to] = [rgb(stops[low] ?? ''), rgb(stops[low + 1] ?? '')];
  const mix = (channel: 0 | 1 | 2) => Math.round(from[channel] + (to[channel] - from[channel]) * (at - low));
  return inked([mix(0), mix(1), mix(2)]);
}

function rgb(hex: string): Rgb {
  const channel = (at: number) => parseInt(hex.slice(at, at + 2), 16);
  return [channel(1), channel(3), channel(5)];
}

function inked(colour: Rgb): Paint {
  const light = luminance(colour);
  const onDark = (luminance(rgb(INK_LIGHT)) + 0.05) / (light + 0.05);
  const onLight = (light + 0.05) / (luminance(rgb(INK_DARK)) + 0.05);
  return { fill: `rgb(${colour.join(' ')})`, ink: onDark > onLight ? INK_LIGHT : INK_DARK };
}

/** Relative luminance, as in WCAG 2. */
function luminance([red, green, blue]: Rgb): number {
  const linear = (value: number) => {
    const share = value / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  };
  return 0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue);
}
