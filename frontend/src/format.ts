/** Numbers and times in words, always as wide whatever they hold, so that nothing jumps. */

const MINUS = '\u2212';
const FIGURE_SPACE = '\u2007';
export const MISSING = '\u2013';
/** Made once: that takes longer than all that a row of a list needs else. */
const DAY = new Intl.DateTimeFormat(undefined, { year: 'numeric', month: 'short', day: 'numeric' });

/** `value` with a fixed number of decimals; a true minus sign, and in its place a space of a digit's width. */
export function fixed(value: number | null | undefined, decimals: number, sign: 'none' | 'space' = 'none'): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return MISSING;
  const digits = Math.abs(value).toFixed(decimals);
  const isZero = Number(digits) === 0;
  if (value < 0 && !isZero) return MINUS + digits;
  return sign === 'none' ? digits : FIGURE_SPACE + digits;
}

/** A compass heading in three digits, 000 to 359, of an angle in rad. */
export function heading(yaw: number | null): string {
  if (yaw === null || !Number.isFinite(yaw)) return MISSING.repeat(3);
  const degrees = Math.round((yaw * 180) / Math.PI) % 360;
  return String((degrees + 360) % 360).padStart(3, '0');
}

/** Seconds as 02:14, or 1:02:14 from an hour on. */
export function duration(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const minutes = Math.floor(whole / 60);
  const rest = String(whole % 60).padStart(2, '0');
  if (minutes < 60) return `${String(minutes).padStart(2, '0')}:${rest}`;
  return `${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, '0')}:${rest}`;
}

/** An age in words: 3.2 s, 14 s, 2 min, 3 h. */
export function age(seconds: number): string {
  if (seconds < 10) return `${seconds.toFixed(1)} s`;
  if (seconds < 120) return `${Math.floor(seconds)} s`;
  if (seconds < 7200) return `${Math.floor(seconds / 60)} min`;
  return `${Math.floor(seconds / 3600)} h`;
}

/** Bytes as kB, MB or GB of powers of ten. */
export function bytes(count: number): string {
  if (count < 1000) return `${count} B`;
  if (count < 1e6) return `${(count / 1e3).toFixed(1)} kB`;
  if (count < 1e9) return `${(count / 1e6).toFixed(1)} MB`;
  return `${(count / 1e9).toFixed(2)} GB`;
}

/** A count with a thin gap between thousands. */
export function count(value: number): string {
  return String(Math.round(value)).replace(/\B(?=(\d{3})+$)/g, '\u202f');
}

/** Local time of day, with tenths where wanted. */
export function timeOfDay(date: Date, tenths = false): string {
  const two = (value: number) => String(value).padStart(2, '0');
  const seconds = `${two(date.getHours())}:${two(date.getMinutes())}:${two(date.getSeconds())}`;
  return tenths ? `${seconds}.${Math.floor(date.getMilliseconds() / 100)}` : seconds;
}

/** Local date and time of day; the zone has to be named beside it. */
export function dateTime(at: Date | string): string {
  const date = new Date(at);
  return `${DAY.format(date)}, ${timeOfDay(date)}`;
}

/** A day such as 2026-05-31 in words, in the browser's language. */
export function dayName(day: string): string {
  return new Date(`${day}T12:00`).toLocaleDateString(undefined, { weekday: 'long', year: 'numeric', month: 'long', day: 'numeric' });
}

/** Local date and time of day with the zone's offset, which may be another in summer. */
export function zonedDateTime(at: Date | string): string {
  const date = new Date(at);
  return `${dateTime(date)} ${zoneOffset(date)}`;
}

/** How far local time is ahead of UTC at that time: UTC, UTC+2, UTC−3:30. */
export function zoneOffset(date: Date): string {
  const minutes = -date.getTimezoneOffset();
  if (minutes === 0) return 'UTC';
  const [hours, rest] = [Math.floor(Math.abs(minutes) / 60), Math.abs(minutes) % 60];
  return `UTC${minutes < 0 ? MINUS : '+'}${hours}${rest === 0 ? '' : `:${String(rest).padStart(2, '0')}`}`;
}

/** The heading of a list of local times, with the zone's name such as Europe/Tallinn. */
export function inZone(heading: string): string {
  return `${heading}, ${new Intl.DateTimeFormat().resolvedOptions().timeZone}`;
}

/** A line speed as people say it: 250k. */
export function baud(value: number): string {
  return value % 1000 === 0 ? `${value / 1000}k` : String(value);
}
