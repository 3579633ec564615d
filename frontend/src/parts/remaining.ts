/** Times that are still to come, in words. */
import { remaining as texts } from '../texts/remaining';

const HOURS_OF_DAYS = 48;

/** A time in s, rounded for reading: about 40 s, about 3 min, about 1 h 10 min, about 3.5 days. */
export function roughly(seconds: number): string {
  if (seconds < 55) return texts.seconds(Math.max(5, Math.ceil(seconds / 5) * 5));
  const minutes = Math.max(1, Math.round(seconds / 60));
  if (minutes < 60) return texts.minutes(minutes);
  const hours = Math.floor(minutes / 60);
  return hours < HOURS_OF_DAYS ? texts.hours(hours, minutes % 60) : texts.days((minutes / 1440).toFixed(1));
}

/** The remaining time of something, of which `remaining` s were left `ago` s ago. */
export function remainingWords(remaining: number | null, ago = 0): string {
  if (remaining === null) return texts.unknown;
  const left = remaining - ago;
  return left < 1 ? texts.moment : roughly(left);
}
