import type { RowRing } from '../../live/ring';

/** s over which the quality of the line is told */
export const QUALITY_OVER = 60;

/** Share of the board's frames that arrived whole during QUALITY_OVER before `now`, 0 to 1; null while none is known. */
export function quality(ring: RowRing<'link'>, now: number): number | null {
  const first = ring.firstSince(now - QUALITY_OVER);
  if (ring.length - first < 2) return null;
  const gained = (name: 'frames_received' | 'frames_missed') => {
    const column = ring.column(name);
    return (column[ring.place(ring.length - 1)] ?? NaN) - (column[ring.place(first)] ?? NaN);
  };
  const received = gained('frames_received');
  const missed = gained('frames_missed');
  // The counts begin anew where the port was opened anew.
  if (!(received >= 0 && missed >= 0 && received + missed > 0)) return null;
  return received / (received + missed);
}
