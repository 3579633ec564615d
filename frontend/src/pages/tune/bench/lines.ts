import type { ActiveTuning, PredictedStep, TuningRunDetail } from '../../../api';
import type { RowRing } from '../../../live/ring';
import type { Rings } from '../../../live/store';
import { sessionColour } from '../../../parts/sessionColour';
import { token } from '../../../theme.svelte';
import type { CurveLine } from './curvePlot';
import type { Loop } from './loops';
import { runTitle } from './words';
import { tune as texts } from '../../../texts/tune';

/** s before the step that a curve begins */
const LEAD = 3;
const TURNING = ['heading', 'pitch', 'roll'];

export function keptLine(run: TuningRunDetail, place: number, theme: 'dark' | 'sunlight', loop: Loop, chosen: boolean): CurveLine {
  return { label: runTitle(run), colour: sessionColour(place, theme), look: chosen ? 'full' : 'pale', ...scaled(run.curve, loop) };
}

export function predictedLine({ curve, model }: PredictedStep, loop: Loop): CurveLine {
  return { label: texts.curves.predicted(model), colour: token('muted'), look: 'ghost', ...scaled(curve, loop) };
}

function scaled({ times, set_points, values, outputs }: TuningRunDetail['curve'], loop: Loop) {
  const shown = (numbers: readonly number[]) => numbers.map((value) => value * loop.factor);
  return { times, setPoints: shown(set_points), values: shown(values), outputs };
}

/** What has come of the run that is on. Before its step the times count from now back. */
export function liveLine(active: ActiveTuning, rings: Rings, now: number, colour: string, loop: Loop): CurveLine {
  const waits = active.kind === 'step' && active.phase === 'settling';
  const zero = active.kind === 'relay' ? active.began : waits ? now : active.since;
  const from = active.kind === 'relay' ? active.began : zero - LEAD;
  const line = { label: texts.curves.live, colour, look: 'full' as const, times: [] as number[], setPoints: [] as number[], values: [] as number[], outputs: [] as number[] };
  const take = <K extends 'control' | 'turning'>(ring: RowRing<K>, columns: readonly ArrayLike<number>[]) => {
    const [setPoints, values, outputs] = columns;
    for (let order = ring.firstSince(from); order < ring.length; order += 1) {
      const place = ring.place(order);
      const value = values?.[place] ?? NaN;
      const setPoint = setPoints?.[place] ?? NaN;
      if (Number.isNaN(value) || Number.isNaN(setPoint)) continue;
      line.times.push((ring.time[place] ?? NaN) - zero);
      line.setPoints.push(setPoint * loop.factor);
      line.values.push(value * loop.factor);
      line.outputs.push(outputs?.[place] ?? 0);
    }
  };
  if (active.loop === 'depth') {
    const ring = rings.control;
    take(ring, [ring.column('set_point'), ring.column('depth'), ring.column('output')]);
  } else {
    const ring = rings.turning;
    const place = TURNING.indexOf(active.loop);
    take(ring, [ring.column('set_point', place), ring.column('measured', place), ring.column('output', place)]);
  }
  return line;
}
