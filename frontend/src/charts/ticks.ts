/** Where an axis of time has its lines, and what is written at them. */
import { timeOfDay } from '../format';

const STEPS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300];
const MINUS = '\u2212';

/** s between two lines, so that at least `least` pixels lie between them. */
export function timeStep(seconds: number, pixels: number, least: number): number {
  const wanted = (seconds * least) / Math.max(pixels, 1);
  return STEPS.find((step) => step >= wanted) ?? STEPS[STEPS.length - 1] ?? seconds;
}

/** Lines at whole steps before the edge, the earliest first; s relative to it. */
export function agesBefore(seconds: number, step: number): number[] {
  const many = Math.floor(seconds / step + 1e-9);
  return Array.from({ length: many + 1 }, (_, index) => -(many - index) * step);
}

/** Lines at whole steps of the calendar, s relative to the edge, which is at `edge` ms since 1970. */
export function momentsBefore(seconds: number, step: number, edge: number): number[] {
  const zero = new Date(edge).setHours(0, 0, 0, 0);
  const end = (edge - zero) / 1000;
  const first = Math.ceil((end - seconds) / step - 1e-9);
  const last = Math.floor(end / step + 1e-9);
  return Array.from({ length: Math.max(0, last - first + 1) }, (_, index) => (first + index) * step - end);
}

export function ageLabel(at: number, step: number): string {
  if (at % 60 === 0 && at <= -60) return `${MINUS}${-at / 60} min`;
  return `${MINUS}${(-at).toFixed(decimals(step))} s`;
}

export function momentLabel(date: Date, step: number): string {
  if (step >= 1) return timeOfDay(new Date(Math.round(date.getTime() / 1000) * 1000));
  const many = decimals(step);
  const rounded = Math.round((date.getTime() / 1000) * 10 ** many) / 10 ** many;
  return timeOfDay(new Date(Math.floor(rounded + 1e-6) * 1000)) + (rounded - Math.floor(rounded + 1e-6)).toFixed(many).slice(1);
}

function decimals(step: number): number {
  return step >= 1 ? 0 : step >= 0.1 ? 1 : 2;
}
