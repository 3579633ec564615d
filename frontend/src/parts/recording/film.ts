/** The space that a film will take. */
import type { FilmPlan } from '../../api';
import { film } from '../../texts/film';

/** Hz */
const RATES = [5, 10, 15, 30];

/** s */
const MINUTE = 60;
const HOUR = 60 * MINUTE;
const DAY = 24 * HOUR;

/** Bytes a second of the film that is chosen. */
const flow = ({ picture_bytes, quality, rate }: FilmPlan): number => picture_bytes[quality] * rate;

/** The rates to choose from: usual ones that the camera's stream has, its own, and the one in force. */
export const rates = ({ rate, rate_max }: FilmPlan): number[] =>
  [...new Set([...RATES.filter((one) => one < rate_max), rate_max, rate])].sort((a, b) => a - b);

/** MB a minute of the film that is chosen, and for how long the disk has room. */
export function space(plan: FilmPlan): string {
  const minute = (flow(plan) * MINUTE) / 1e6;
  return film.choice.takes(minute.toFixed(minute < 10 ? 1 : 0), time(plan.room / flow(plan)));
}

function time(seconds: number): string {
  const { minutes, hours, days } = film.choice;
  if (seconds < 2 * HOUR) return minutes(Math.floor(seconds / MINUTE));
  if (seconds < 4 * DAY) return hours(Math.floor(seconds / HOUR));
  return days(Math.floor(seconds / DAY));
}
