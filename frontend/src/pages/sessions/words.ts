/** A session in words. */
import type { Session, SessionDetail } from '../../api';
import { count } from '../../format';

export const STATE_HINTS: Record<Session['state'], string> = {
  recording: 'still being written',
  complete: 'everything was kept',
  interrupted: 'the server stopped while it recorded; what had been written by then is kept',
};

export const ORIGINS: Record<Session['origin'], string> = {
  operator: 'by hand',
  arming: 'at arming',
  scenario: 'scenario, live',
  simulated: 'scenario, simulated time',
  import: 'imported',
};

type Gap = SessionDetail['gaps'][number];

/** What is missing, and why, in a sentence. */
export function gapWords(gap: Gap): string {
  const samples = gap.missed === 1 ? '1 sample' : `${count(gap.missed)} samples`;
  if (gap.kind === 'missed') return `${samples} of ${gap.topic} never arrived`;
  if (gap.kind === 'restarted') return `what sends ${gap.topic} was started anew`;
  if (gap.kind === 'not stored') return `${samples} of ${gap.topic} could not be stored, the disk was full or failed`;
  return `${samples} of ${gap.topic} arrived damaged`;
}
