/** Which small pictures stand for a whole session. */
import type { SessionDetail } from '../../api';

const FRAMES = 24;

/** The topic of which small pictures are made, if any; a film that is `readable` gives them where there are no others. */
export const pictured = (topics: SessionDetail['topics'], readable: boolean) =>
  topics.find(({ name }) => name === 'thumbnail') ?? (readable ? topics.find(({ name }) => name === 'film') : undefined);

/** Times, s since the start, spread evenly over what there are pictures of. */
export function frames(pictures: SessionDetail['topics'][number] | undefined): number[] {
  if (pictures === undefined) return [];
  const { first, last, count } = pictures;
  const wanted = Math.min(count, FRAMES);
  if (wanted === 1) return [first];
  return Array.from({ length: wanted }, (_, place) => first + ((last - first) * place) / (wanted - 1));
}

/** The first picture from a time on is asked for; rounding must not step beyond the last one. */
export const asked = (time: number): number => Math.floor(time * 1000) / 1000;
