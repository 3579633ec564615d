/** Angles in charts: from π the line goes on at -π, without a line from edge to edge. */
import type { Range } from './range';

/** rad */
const TURN = 2 * Math.PI;

/** What a line is drawn with: a canvas, or a pen on it. */
export type Pen = Pick<CanvasRenderingContext2D, 'moveTo' | 'lineTo'>;

/** The same angle on the turn on which it is nearest to `near`; unchanged where that is NaN. */
export function unwrap(angle: number, near: number): number {
  return Number.isNaN(near) ? angle : angle + TURN * Math.round((near - angle) / TURN);
}

/** The range of unwrapped angles within -π to π: all of it where they lie on several turns. */
export function wrapRange([least, most]: Range): Range {
  const [first, last] = [Math.round(least / TURN), Math.round(most / TURN)];
  return first === last ? [least - TURN * first, most - TURN * first] : [-Math.PI, Math.PI];
}

/** Draws lines between unwrapped angles within -π to π, broken where they pass from one edge to the other. */
export class AnglePen implements Pen {
  readonly #height: number;
  #x = NaN;
  #y = NaN;
  #turn = 0;

  /** @param zero px of the angle 0; @param unit px of one rad */
  constructor(
    private readonly pen: Pen,
    private readonly zero: number,
    unit: number,
  ) {
    this.#height = Math.abs(unit) * TURN;
  }

  moveTo(x: number, y: number): void {
    this.#turn = this.#turnOf(y);
    this.pen.moveTo(x, y - this.#turn * this.#height);
    [this.#x, this.#y] = [x, y];
  }

  lineTo(x: number, y: number): void {
    const end = this.#turnOf(y);
    const step = Math.sign(end - this.#turn);
    for (; this.#turn !== end; this.#turn += step) {
      const edge = this.zero + (this.#turn + step / 2) * this.#height;
      const at = this.#x + ((x - this.#x) * (edge - this.#y)) / (y - this.#y);
      this.pen.lineTo(at, edge - this.#turn * this.#height);
      this.pen.moveTo(at, edge - (this.#turn + step) * this.#height);
    }
    this.pen.lineTo(x, y - end * this.#height);
    [this.#x, this.#y] = [x, y];
  }

  #turnOf(y: number): number {
    return Math.round((y - this.zero) / this.#height);
  }
}
