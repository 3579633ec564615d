import type { Session } from '../../api';
import { fixed } from '../../format';
import { scenarios } from '../../texts/scenarios';

/** What came of a run, in words; none while nobody has read it. A scenario has no limits that it passes or fails. */
export function resultWords(summary: Session['summary']): string[] {
  if (!summary) return [];
  const { deepest, alarms } = scenarios.runs;
  return [...(summary.depth === null ? [] : [deepest(fixed(summary.depth, 2))]), alarms(summary.alarms)];
}
