import type { Detection, State } from '../generated/topics';

/** what is seen of the robot */
export interface Sight {
  readonly detections: readonly Detection[];
  readonly state: State | null;
}

/** share of the time between two pictures by which a detection's may differ from the one shown, and still be drawn on it */
const SAME_PICTURE = 0.6;

/** s before the newest detection that a replay keeps older ones: its pictures are 2 s apart */
const KEPT = 3;

/** The detections of a replay that may be of the picture it shows, with newer ones, in order of time. */
export function keepDetections(kept: readonly Detection[], newer: readonly Detection[]): Detection[] {
  const since = (newer.at(-1)?.time ?? -Infinity) - KEPT;
  return [...kept, ...newer].filter(({ time }) => time >= since);
}

/** Detection in this picture; null where that is of another one by more than `periods` between two searched, or not known. */
export function foundIn({ detections, state }: Sight, picture: { readonly time: number } | null, periods = SAME_PICTURE): Detection | null {
  if (picture === null || state === null) return null;
  const away = ({ taken }: Detection) => Math.abs(taken - picture.time);
  const [detection] = detections.toSorted((one, other) => away(one) - away(other));
  if (detection === undefined) return null;
  return Math.abs(detection.taken - picture.time) * state.vision_rate < periods ? detection : null;
}
