import type { Detection } from '../generated/topics';
import type { Live } from './live.svelte';

/** share of the time between two pictures by which a detection's may differ from the one shown, and still be drawn on it */
const SAME_PICTURE = 0.6;

/** Detection in this picture; null where that is of another one, or not known. */
export function foundIn({ detection, state }: Live, picture: { readonly time: number } | null): Detection | null {
  if (detection === null || picture === null || state === null) return null;
  return Math.abs(detection.taken - picture.time) * state.vision_rate < SAME_PICTURE ? detection : null;
}
