import { token } from '../theme.svelte';

/** The artificial horizon as it is seen from inside, in a circle of 88 units about 0. */

export interface Look {
  readonly sky: string;
  readonly earth: string;
  readonly edge: string;
  readonly glass: string;
  readonly bank: string;
  readonly level: string;
  readonly craft: string;
  readonly font: string;
}

/** units per degree of pitch */
const PER_DEGREE = 1.6;
const LADDER = [-60, -50, -40, -30, -20, -10, 10, 20, 30, 40, 50, 60] as const;
const BANK = [-60, -45, -30, -20, -10, 0, 10, 20, 30, 45, 60] as const;
const RADIUS = 88;
const FAR = 300;
const POINTER = 'M0 -86l-5 9h10z';
const CRAFT = 'M-52 0h28l6 8M52 0h-28l-6 8';

/** Draw it at this roll and pitch (°). */
export function paintHorizon(context: CanvasRenderingContext2D, roll: number, pitch: number, look: Look): void {
  context.lineCap = 'butt';
  context.save();
  circle(context, RADIUS);
  context.clip();
  turn(context, -roll);
  context.translate(0, pitch * PER_DEGREE);
  world(context, look);
  context.restore();
  context.strokeStyle = look.glass;
  context.lineWidth = 1.5;
  circle(context, RADIUS);
  context.stroke();
  banks(context, roll, look);
  context.fillStyle = look.edge;
  context.fill(new Path2D(POINTER));
  craft(context, look);
}

function world(context: CanvasRenderingContext2D, look: Look): void {
  context.fillStyle = look.sky;
  context.fillRect(-FAR, -FAR, 2 * FAR, FAR);
  context.fillStyle = look.earth;
  context.fillRect(-FAR, 0, 2 * FAR, FAR);
  context.strokeStyle = context.fillStyle = look.edge;
  context.lineWidth = 1.5;
  line(context, -FAR, 0, FAR, 0);
  context.font = look.font;
  context.textBaseline = 'alphabetic';
  context.textAlign = 'left';
  context.lineWidth = 1;
  for (const angle of LADDER) {
    const long = angle % 20 === 0;
    const half = long ? 22 : 12;
    const y = -angle * PER_DEGREE;
    context.globalAlpha = 0.75;
    line(context, -half, y, half, y);
    context.globalAlpha = 1;
    if (long) context.fillText(String(Math.abs(angle)), half + 4, y + 3);
  }
}

function banks(context: CanvasRenderingContext2D, roll: number, look: Look): void {
  for (const angle of BANK) {
    context.save();
    turn(context, angle - roll);
    context.strokeStyle = angle === 0 ? look.level : look.bank;
    context.lineWidth = angle === 0 ? 3 : 1.5;
    line(context, 0, -RADIUS, 0, angle % 30 === 0 ? -97 : -93);
    context.restore();
  }
}

function craft(context: CanvasRenderingContext2D, look: Look): void {
  context.strokeStyle = context.fillStyle = look.craft;
  context.lineWidth = 4;
  context.lineJoin = 'round';
  context.lineCap = 'round';
  context.stroke(new Path2D(CRAFT));
  circle(context, 2.5);
  context.fill();
}

function turn(context: CanvasRenderingContext2D, degrees: number): void {
  context.rotate((degrees * Math.PI) / 180);
}

function line(context: CanvasRenderingContext2D, x: number, y: number, toX: number, toY: number): void {
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(toX, toY);
  context.stroke();
}

function circle(context: CanvasRenderingContext2D, radius: number): void {
  context.beginPath();
  context.arc(0, 0, radius, 0, 2 * Math.PI);
}

/** Colours and font of the present theme. */
export const horizonLook = (): Look => ({
  sky: token('sky'),
  earth: token('earth'),
  edge: token('on-horizon'),
  glass: token('line-strong'),
  bank: token('muted'),
  level: token('text'),
  craft: token('aircraft'),
  font: `${token('drawing')} ${token('font')}`,
});
