/** The robot from above with its fins, and a dial for each fin. */
import { degrees } from '../attitude';
import { token } from '../theme.svelte';

export interface Look {
  readonly leaf: string;
  readonly shell: string;
  readonly edge: string;
  readonly face: string;
  readonly tick: string;
  readonly hub: string;
  readonly measured: string;
  readonly wanted: string;
  readonly drive: string;
  readonly track: string;
}

/** State of one fin. */
interface FinState {
  /** rad */
  readonly angle: number;
  readonly wanted: number;
  /** -63 to 63 */
  readonly drive: number;
}

interface Place {
  readonly name: string;
  /** 1 on the right of the body, -1 on the left: a dial's zero points outwards, tip down is down */
  readonly side: 1 | -1;
  /** the dial's centre */
  readonly x: number;
  readonly y: number;
  /** where the fin joins the body, and its rest (°) */
  readonly mount: readonly [number, number];
  readonly aim: number;
}

/** in the order of the packet */
export const FINS: readonly Place[] = [
  { name: 'FR', side: 1, x: 108, y: -56, mount: [31, -50], aim: 60 },
  { name: 'BR', side: 1, x: 108, y: 60, mount: [31, 50], aim: -60 },
  { name: 'BL', side: -1, x: -108, y: 60, mount: [-31, 50], aim: -120 },
  { name: 'FL', side: -1, x: -108, y: -56, mount: [-31, -50], aim: 120 },
];
const RADIUS = 32;
const DRIVE_MOST = 63;
const RADIAN = Math.PI / 180;
const LEAF = 'M-4 0C6 -11 32 -11 44 0C32 11 6 11 -4 0z';
const SHELL = 'M0 -74C24 -74 38 -44 38 0S24 74 0 74S-38 44 -38 0S-24 -74 0 -74z';
const HEAD = 'M13 -86A13 13 0 1 1 -13 -86A13 13 0 1 1 13 -86z';
const SEAM = 'M0 -66V66M-30 -34H30M-37 0H37M-30 34H30';

/** Draw the robot and its dials; `states` in the order of FINS. */
export function paintFins(context: CanvasRenderingContext2D, states: readonly FinState[], look: Look): void {
  context.lineCap = 'butt';
  context.lineWidth = 1.5;
  FINS.forEach((place, index) => leaf(context, place, states[index]?.angle ?? 0, look));
  context.fillStyle = look.shell;
  context.strokeStyle = look.edge;
  for (const outline of [SHELL, HEAD]) {
    const part = new Path2D(outline);
    context.fill(part);
    context.stroke(part);
  }
  context.globalAlpha = 0.6;
  context.stroke(new Path2D(SEAM));
  context.globalAlpha = 1;
  FINS.forEach((place, index) => {
    const state = states[index];
    if (state) dial(context, place, state, look);
  });
}

/** A fin seen from above, which grows short as its tip leaves the plane. */
function leaf(context: CanvasRenderingContext2D, { mount, aim }: Place, angle: number, look: Look): void {
  const outline = new Path2D();
  outline.addPath(new Path2D(LEAF), new DOMMatrix().translate(...mount).rotate(aim).scale(0.25 + 0.75 * Math.abs(Math.cos(angle)), 1));
  context.fillStyle = look.leaf;
  context.strokeStyle = look.measured;
  context.fill(outline);
  context.stroke(outline);
}

function dial(context: CanvasRenderingContext2D, { side, x, y }: Place, { angle, wanted, drive }: FinState, look: Look): void {
  context.save();
  context.translate(x, y);
  context.lineWidth = 1;
  context.beginPath();
  context.arc(0, 0, RADIUS, 0, 2 * Math.PI);
  context.fillStyle = look.face;
  context.strokeStyle = look.edge;
  context.fill();
  context.stroke();
  context.strokeStyle = look.tick;
  line(context, (RADIUS - 6) * side, 0, RADIUS * side, 0);
  line(context, 0, -RADIUS, 0, -RADIUS + 6);
  line(context, 0, RADIUS - 6, 0, RADIUS);
  const turned = (value: number) => (side === 1 ? degrees(value) : 180 - degrees(value)) * RADIAN;
  context.strokeStyle = look.wanted;
  context.lineWidth = 2;
  context.setLineDash([4, 3]);
  hand(context, turned(wanted), RADIUS);
  context.setLineDash([]);
  context.strokeStyle = look.measured;
  context.lineWidth = 4;
  context.lineCap = 'round';
  hand(context, turned(angle), RADIUS - 4);
  context.fillStyle = look.hub;
  context.beginPath();
  context.arc(0, 0, 3.5, 0, 2 * Math.PI);
  context.fill();
  bar(context, drive, look);
  context.restore();
}

function bar(context: CanvasRenderingContext2D, drive: number, look: Look): void {
  const share = Math.max(-1, Math.min(1, drive / DRIVE_MOST));
  context.fillStyle = look.track;
  context.beginPath();
  context.roundRect(-RADIUS, 39, 2 * RADIUS, 5, 1);
  context.fill();
  context.fillStyle = look.drive;
  context.fillRect(0, 39, share * RADIUS, 5);
  context.strokeStyle = look.tick;
  context.lineWidth = 1;
  context.lineCap = 'butt';
  line(context, 0, 37, 0, 46);
}

function hand(context: CanvasRenderingContext2D, angle: number, length: number): void {
  line(context, 0, 0, length * Math.cos(angle), length * Math.sin(angle));
}

function line(context: CanvasRenderingContext2D, x: number, y: number, toX: number, toY: number): void {
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(toX, toY);
  context.stroke();
}

/** The colours of the present theme. */
export const finLook = (): Look => ({
  leaf: token('well'),
  shell: token('raised'),
  edge: token('line-strong'),
  face: token('well'),
  tick: token('muted'),
  hub: token('text'),
  measured: token('series-measured'),
  wanted: token('series-wanted'),
  drive: token('series-third'),
  track: token('raised'),
});
