/** The gaps of a session in words. */
import type { SessionDetail } from '../../api';
import { count } from '../../format';
import { sessions as texts } from '../../texts/sessions';

type Gap = SessionDetail['gaps'][number];

/** A gap and its cause in a sentence. */
export function gapWords(gap: Gap): string {
  const samples = texts.gaps.samples(gap.missed === 1, count(gap.missed));
  if (gap.kind === 'missed') return texts.gaps.missed(samples, gap.topic);
  if (gap.kind === 'restarted') return texts.gaps.restarted(gap.topic);
  if (gap.kind === 'not stored') return texts.gaps.notStored(samples, gap.topic);
  if (gap.kind === 'removed') return texts.gaps.removed(count(gap.missed));
  return texts.gaps.damaged(samples, gap.topic);
}
