import { mixedPaint } from '../../../charts/shades';
import type { Paint } from '../../../parts/table';
import { token } from '../../../theme.svelte';

/** From the worst on, in the theme as it stands: one hue, which grows stronger. */
export const shadeStops = (): string[] => [token('raised'), token('series-measured')];

export const shadePaint = (share: number, stops: readonly string[]): Paint => mixedPaint(stops, share);
