/** Names of the segments of a dive. */
import type { Segment } from '../api';
import { fixed } from '../format';
import { story as texts } from '../texts/story';
import { swimmerOf } from './profile';

/** Who swam, and at which set point. */
export function nameSegment(segment: Segment): string {
  const { title } = swimmerOf(segment, texts.profile.kinds);
  if (!segment.holds_depth) return title;
  return `${title}, ${segment.set_point === null ? texts.figures.moving : `${fixed(segment.set_point, 2)} m`}`;
}
