import { FLANK, HEAD_FACETS, HULL, LENS, MOUNTS, NECK, finAt, type Facet } from './shape';
import { dot, eyeOf, FOCAL, turn, turnBack, unit as unitOf, type Camera, type Eye, type Quaternion, type Vector } from './space';
import { panels as texts } from '../../texts/panels';

export interface Pose {
  readonly attitude: Quaternion;
  /** rad, measured */
  readonly fins: readonly number[];
  /** m; null while unknown */
  readonly depth: number | null;
}

/** Colours as #rrggbb, and fonts. */
export interface Look {
  readonly shell: string;
  readonly scute: string;
  readonly belly: string;
  readonly head: string;
  readonly lens: string;
  readonly fin: string;
  readonly edge: string;
  readonly ring: string;
  readonly text: string;
  readonly water: string;
  /** of the points of the compass */
  readonly letters: string;
  readonly words: string;
}

/** m that the surface is drawn above the robot at most; from there on a word says how far it is */
const SURFACE_MOST = 0.1;
const SURFACE_RADIUS = 0.18;
const RING_RADIUS = 0.18;
/** m below the robot */
const RING_BELOW = 0.08;
/** m that the picture's width and height show at least */
const SHOWN = [0.48, 0.44] as const;
const LIGHT = unitOf([0.35, 0.5, -1]);
const LETTERS = ['N', 'E', 'S', 'W'] as const;

/** Draws the robot into a picture of this size (CSS pixels). */
export function paint(context: CanvasRenderingContext2D, width: number, height: number, camera: Camera, pose: Pose, look: Look): void {
  const eye = eyeOf(camera);
  const unit = (Math.min(width / SHOWN[0], height / SHOWN[1]) * camera.distance) / FOCAL;
  const pen = new Pen(context, (place) => {
    const [right, down] = eye.see(place);
    return [width / 2 + right * unit, height * 0.47 + down * unit];
  });
  context.clearRect(0, 0, width, height);
  compass(pen, look);
  robot(pen, eye, pose, look);
  if (pose.depth !== null) surface(pen, pose.depth, look);
}

class Pen {
  constructor(
    readonly context: CanvasRenderingContext2D,
    readonly at: (place: Vector) => readonly [number, number],
  ) {}

  polygon(corners: readonly Vector[]): void {
    const { context } = this;
    context.beginPath();
    for (const corner of corners) context.lineTo(...this.at(corner));
    context.closePath();
  }

  fill(corners: readonly Vector[], colour: string, edge = colour): void {
    this.polygon(corners);
    this.context.fillStyle = colour;
    this.context.fill();
    // In its own colour, so that no gap shows between two pieces.
    this.context.strokeStyle = edge;
    this.context.stroke();
  }
}

function robot(pen: Pen, eye: Eye, { attitude, fins }: Pose, look: Look): void {
  pen.context.lineWidth = 0.8;
  pen.context.lineJoin = 'round';
  const from = turnBack(attitude, eye.place);
  const facets = (all: readonly Facet[]) => {
    for (const { corners, normal, part } of all) {
      const [corner] = corners;
      if (corner === undefined || dot(normal, from) <= dot(normal, corner)) continue;
      const light = brightness(turn(attitude, normal));
      pen.fill(corners.map((one) => turn(attitude, one)), shade(look[part], light));
    }
  };
  const head = () => {
    facets(HEAD_FACETS);
    if (from[0] > NECK) pen.fill(LENS.map((one) => turn(attitude, one)), look.lens);
  };
  const side = (right: number) => {
    const own = MOUNTS.map((mount, index) => ({ ...mount, index })).filter((mount) => mount.right === right);
    const far = ({ pivot }: { pivot: Vector }) => Math.hypot(pivot[0] - from[0], pivot[1] - from[1], pivot[2] - from[2]);
    for (const { index } of own.sort((a, b) => far(b) - far(a))) {
      const { corners, normal } = finAt(index, fins[index] ?? 0);
      const light = Math.max(brightness(turn(attitude, normal)), brightness(turn(attitude, [-normal[0], -normal[1], -normal[2]])));
      pen.fill(corners.map((one) => turn(attitude, one)), shade(look.fin, light), look.edge);
    }
  };
  // What lies beyond a plane that parts it from the rest comes first: no piece has to be sorted.
  for (const right of [1, -1]) if (from[1] * right <= FLANK) side(right);
  if (from[0] <= NECK) head();
  facets(HULL);
  if (from[0] > NECK) head();
  for (const right of [1, -1]) if (from[1] * right > FLANK) side(right);
}

/** A circle on the level, `down` below the robot's middle. */
const circle = (radius: number, down: number): Vector[] =>
  Array.from({ length: 48 }, (_, index) => {
    const angle = (2 * Math.PI * index) / 48;
    return [radius * Math.cos(angle), radius * Math.sin(angle), down];
  });

function compass(pen: Pen, look: Look): void {
  const { context } = pen;
  context.lineWidth = 1;
  context.strokeStyle = look.ring;
  pen.polygon(circle(RING_RADIUS, RING_BELOW));
  context.stroke();
  context.font = look.letters;
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  for (let tick = 0; tick < 12; tick += 1) {
    const angle = (Math.PI * tick) / 6;
    const at = (radius: number) => pen.at([radius * Math.cos(angle), radius * Math.sin(angle), RING_BELOW]);
    context.beginPath();
    context.moveTo(...at(RING_RADIUS));
    context.lineTo(...at(RING_RADIUS - (tick % 3 === 0 ? 0.015 : 0.008)));
    context.stroke();
    context.fillStyle = look.text;
    if (tick % 3 === 0) context.fillText(LETTERS[tick / 3] ?? '', ...at(RING_RADIUS + 0.02));
  }
}

function surface(pen: Pen, depth: number, look: Look): void {
  const { context } = pen;
  const above = Math.min(Math.max(depth, -SURFACE_MOST), SURFACE_MOST);
  const far = depth > SURFACE_MOST;
  const ring = circle(SURFACE_RADIUS, -above);
  pen.polygon(ring);
  context.strokeStyle = look.water;
  context.lineWidth = 1.2;
  context.setLineDash(far ? [3, 5] : []);
  context.stroke();
  context.setLineDash([]);
  if (!far) {
    context.globalAlpha = 0.16;
    context.fillStyle = look.water;
    context.fill();
    context.globalAlpha = 1;
  }
  context.fillStyle = look.text;
  context.font = look.words;
  context.textAlign = 'center';
  context.textBaseline = 'bottom';
  // At the far side of its circle.
  const [x, y] = ring.map(pen.at).reduce((highest, one) => (one[1] < highest[1] ? one : highest));
  context.fillText(far ? texts.robot.surfaceAbove(depth.toFixed(2)) : texts.robot.surface, x, Math.max(14, y - 4));
}

/** 0 to 1, of a face that looks this way in the world */
const brightness = (normal: Vector): number => 0.5 + 0.5 * Math.max(-0.6, dot(normal, LIGHT));

/** A colour in less light, or in more than its own. */
function shade(colour: string, light: number): string {
  const parts = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  const lit = parts.map((part) => Math.round(Math.min(255, part * (0.4 + 0.65 * light))));
  return `rgb(${lit.join(' ')})`;
}
