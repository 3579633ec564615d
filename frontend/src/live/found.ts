import type { Detection } from '../generated/topics';
import type { Live } from './live.svelte';

/** share of the time between two pictures by which a detection's may differ from the one shown, and still be drawn on it */
const SAME_PICTURE = 0.6;

/** Detection in this picture; null where that is of another one by more than `periods` between two searched, or not known. */
export function foundIn({ documents, state }: Pick<Live, 'documents' | 'state'>, picture: { readonly time: number } | null, periods = SAME_PICTURE): Detection | null {
  const detection = documents.detection.value;
  if (detection === null || picture === null || state === null) return null;
  return Math.abs(detection.taken - picture.time) * state.vision_rate < periods ? detection : null;
}
