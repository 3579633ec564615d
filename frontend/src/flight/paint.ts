/** The instruments over the picture: thin white lines with a dark edge, which can be read in sunlight. */
import { fixed, heading as headingWords } from '../format';
import { compassMarks, compassName, onTape, tapeMarks, turnTo, type Rect } from './geometry';
import type { Aged, Readings } from './readings';

export interface Look {
  readonly line: string;
  /** of a value too old to be trusted */
  readonly old: string;
  /** of the set point */
  readonly held: string;
  readonly edge: string;
  /** behind the value in the middle of a tape */
  readonly shade: string;
  readonly marks: string;
  readonly value: string;
}

/** px a metre, and a degree of heading and of pitch, on a picture of 900 px; on smaller ones less, down to a half */
const PER_METRE = 220;
const PER_DEGREE = 7;
const PER_PITCH = 8;
const PITCH_LADDER = [-20, -10, 10, 20] as const;
const BANKS = [-60, -45, -30, -20, -10, 0, 10, 20, 30, 45, 60] as const;

/**
 * Draw them over `area`, the part of the picture that nothing else covers.
 *
 * @param inside whether the picture is seen from inside, where the horizon means something
 */
export function paintInstruments(context: CanvasRenderingContext2D, area: Rect, readings: Readings, look: Look, inside: boolean): void {
  const pen = new Pen(context, look);
  const scale = Math.min(1.2, Math.max(0.5, area.height / 900));
  const { attitude, depth } = readings;
  pen.at(isOld(attitude) ? look.old : look.line);
  if (attitude) {
    if (inside) horizon(pen, area, attitude.value.roll, attitude.value.pitch, scale);
    compass(pen, area, attitude.value.heading, readings.headingHeld, scale);
  }
  pen.at(isOld(depth) ? look.old : look.line);
  if (depth) depthTape(pen, area, depth.value, readings.depthHeld, scale);
}

const isOld = (read: Aged<unknown> | null) => read !== null && read.old !== null;

/** Lines and words with an edge; an edge first, then the line, so that crossing lines stay whole. */
class Pen {
  #colour = '';
  constructor(
    readonly context: CanvasRenderingContext2D,
    readonly look: Look,
  ) {
    context.lineJoin = 'round';
    context.lineCap = 'round';
  }

  at(colour: string): void {
    this.#colour = colour;
  }

  lines(path: Path2D, width = 1.5, colour = this.#colour): void {
    const { context, look } = this;
    context.strokeStyle = look.edge;
    context.lineWidth = width + 2.5;
    context.stroke(path);
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke(path);
  }

  words(text: string, x: number, y: number, font: string, align: CanvasTextAlign, colour = this.#colour): void {
    const { context, look } = this;
    context.font = font;
    context.textAlign = align;
    context.textBaseline = 'middle';
    context.strokeStyle = look.edge;
    context.lineWidth = 3.5;
    context.strokeText(text, x, y);
    context.fillStyle = colour;
    context.fillText(text, x, y);
  }

  /** The value in the middle of a tape, on a shade. */
  box(x: number, y: number, width: number, height: number, text: string): void {
    const { context, look } = this;
    const path = new Path2D();
    path.roundRect(x, y, width, height, 4);
    context.fillStyle = look.shade;
    context.fill(path);
    this.lines(path);
    this.words(text, x + width / 2, y + height / 2 + 1, look.value, 'center');
  }
}

const segment = (path: Path2D, x: number, y: number, toX: number, toY: number) => {
  path.moveTo(x, y);
  path.lineTo(toX, toY);
};

function horizon(pen: Pen, area: Rect, roll: number, pitch: number, scale: number): void {
  const { context, look } = pen;
  const half = Math.min(area.width * 0.22, area.height * 0.32);
  const [gap, perPitch] = [half * 0.2, PER_PITCH * scale];
  context.save();
  context.translate(area.x + area.width / 2, area.y + area.height / 2);
  const craft = new Path2D();
  segment(craft, -gap * 0.8, 0, -gap * 0.35, 0);
  segment(craft, gap * 0.35, 0, gap * 0.8, 0);
  craft.moveTo(3, 0);
  craft.arc(0, 0, 3, 0, 2 * Math.PI);
  pen.lines(craft, 2.5);
  const pointer = new Path2D(`M0 ${-half}l-5 -8h10z`);
  context.rotate((-roll * Math.PI) / 180);
  const banks = new Path2D();
  for (const bank of BANKS) {
    const turned = ((bank - 90) * Math.PI) / 180;
    const [x, y] = [Math.cos(turned), Math.sin(turned)];
    const long = half + (bank % 30 === 0 ? 12 : 7);
    segment(banks, x * half, y * half, x * long, y * long);
  }
  pen.lines(banks);
  context.beginPath();
  context.arc(0, 0, half - 4, 0, 2 * Math.PI);
  context.clip();
  context.translate(0, pitch * perPitch);
  const level = new Path2D();
  segment(level, -half, 0, -gap, 0);
  segment(level, gap, 0, half, 0);
  const ladder = new Path2D();
  for (const angle of PITCH_LADDER) {
    const y = -angle * perPitch;
    segment(ladder, -gap * 1.1, y, -gap * 0.5, y);
    segment(ladder, gap * 0.5, y, gap * 1.1, y);
  }
  pen.lines(level, 2);
  pen.lines(ladder, 1.25);
  for (const angle of PITCH_LADDER) {
    pen.words(String(Math.abs(angle)), gap * 1.1 + 5, -angle * perPitch, look.marks, 'left');
  }
  context.restore();
  context.save();
  context.translate(area.x + area.width / 2, area.y + area.height / 2);
  pen.lines(pointer, 1.25);
  context.restore();
}

function compass(pen: Pen, area: Rect, heading: number, held: number | null, scale: number): void {
  const { context, look } = pen;
  const reach = Math.min(260, area.width * 0.3);
  const perDegree = PER_DEGREE * Math.max(0.6, scale);
  const [middle, top] = [area.x + area.width / 2, area.y + 12];
  const marks = new Path2D();
  const shown = compassMarks(heading, reach, perDegree);
  for (const { at, named } of shown) segment(marks, middle + at, top + 32, middle + at, top + (named ? 22 : 27));
  segment(marks, middle - reach, top + 32, middle + reach, top + 32);
  pen.lines(marks);
  // What would lie under the value in the middle is left out.
  for (const { at, value, named } of shown) if (named && Math.abs(at) > 40) pen.words(compassName(value), middle + at, top + 12, look.marks, 'center');
  pen.box(middle - 30, top, 60, 26, `${headingWords((heading * Math.PI) / 180)}°`);
  if (held === null) return;
  const bug = onTape(turnTo(heading, held) * perDegree, reach);
  context.save();
  context.translate(middle + bug.at, top + 34);
  const mark = new Path2D('M0 0l6 9h-12z');
  pen.lines(mark, 1.5, look.held);
  if (!bug.beyond) fill(context, mark, look.held);
  context.restore();
}

function depthTape(pen: Pen, area: Rect, depth: number, held: number | null, scale: number): void {
  const { context, look } = pen;
  const reach = Math.max(60, Math.min(300, area.height / 2 - 64));
  const perMetre = PER_METRE * scale;
  const [right, middle] = [area.x + area.width - 14, area.y + area.height / 2];
  const marks = new Path2D();
  const shown = tapeMarks(depth, reach, perMetre, 0.1, 5, 0);
  for (const { at, named } of shown) segment(marks, right, middle + at, right - (named ? 14 : 7), middle + at);
  // The tape begins at the surface.
  segment(marks, right, middle + Math.max(-reach, -depth * perMetre), right, middle + reach);
  pen.lines(marks);
  for (const { at, value, named } of shown) {
    if (named && Math.abs(at) > 22) pen.words(fixed(value, 1), right - 20, middle + at, look.marks, 'right');
  }
  pen.box(right - 98, middle - 14, 82, 28, `${fixed(depth, 2)} m`);
  if (held === null) return;
  const bug = onTape((held - depth) * perMetre, reach);
  context.save();
  context.translate(right + 2, middle + bug.at);
  const mark = new Path2D('M0 0l9 -6v12z');
  pen.lines(mark, 1.5, look.held);
  if (!bug.beyond) fill(context, mark, look.held);
  context.restore();
  // Where its value would lie under the depth's, the mark alone says that it is reached.
  if (Math.abs(bug.at) > 26) {
    const line = new Path2D();
    segment(line, right - 40, middle + bug.at, right, middle + bug.at);
    context.setLineDash([5, 5]);
    pen.lines(line, 1.5, look.held);
    context.setLineDash([]);
    pen.words(fixed(held, 2), right - 46, middle + bug.at, look.marks, 'right', look.held);
  }
}

function fill(context: CanvasRenderingContext2D, path: Path2D, colour: string): void {
  context.fillStyle = colour;
  context.fill(path);
}
