/** A sweep's figure as a chart of Plotly: over one parameter with its spread, over two where both are drawn by chance, or in the order of the trials. */
import type { Data, Layout } from 'plotly.js-basic-dist-min';
import type { FigureMeaning, SweepRunDetail, SweepVariant } from '../../../api';
import { sweeps } from '../../../texts/sweeps';
import { meanOf, rankOf, type Axis, type Plane, type Value } from './plane';
import { withUnit } from './words';

export interface Drawing {
  readonly plane: Plane;
  readonly variants: readonly SweepVariant[];
  /** of these variants; as far as they are known */
  readonly runs: readonly SweepRunDetail[];
  /** titles of the axes */
  readonly across: string;
  readonly up: string;
  /** numbers of those that are marked; null: none */
  readonly best: number | null;
  readonly chosen: number | null;
  /** the colour of a figure's value, where the colour tells it */
  readonly fill: (value: number) => string;
  readonly words: (variant: SweepVariant) => string;
  readonly token: (name: string) => string;
}

interface Point {
  readonly variant: SweepVariant;
  readonly x: Value;
  readonly y: Value;
  readonly mean: number;
  readonly low: number | null;
  readonly high: number | null;
}

/** px of a variant's dot, and of a seed's */
const DOT = 9;
const SEED = 5;

export function drawChart(drawing: Drawing): { readonly data: Data[]; readonly layout: Partial<Layout> } {
  const { plane, across, up, token } = drawing;
  const points = pointsOf(drawing);
  const title = plane.up === null ? `${plane.figure.title}${plane.figure.unit === '' ? '' : ` (${plane.figure.unit})`}` : up;
  const lined = plane.up === null && plane.across !== null && !plane.across.scattered && plane.across.values.every((value) => typeof value === 'number');
  const data: Data[] = [
    ...(lined ? spread(points, token) : []),
    ...(plane.across === null ? [bestSoFar(points, plane.figure, token)] : []),
    ...(plane.up === null ? [seedDots(drawing, points)] : []),
    dots(points, drawing, lined),
  ];
  const font = { family: token('font'), size: 12, color: token('muted') };
  const axis = { gridcolor: token('line'), zeroline: false, automargin: true, fixedrange: true };
  const layout = {
    margin: { l: 56, r: 12, t: 12, b: 48 },
    paper_bgcolor: token('panel'),
    plot_bgcolor: token('panel'),
    font,
    showlegend: false,
    hovermode: 'closest',
    dragmode: false,
    hoverlabel: { bgcolor: token('panel'), bordercolor: token('line'), font: { ...font, color: token('text') } },
    xaxis: { ...axis, ...kindOf(plane.across), title: { text: across, standoff: 8, font } },
    yaxis: { ...axis, ...kindOf(plane.up), title: { text: title, standoff: 8, font } },
  } as unknown as Partial<Layout>;
  return { data, layout };
}

const kindOf = (axis: Axis | null): object => (axis?.values.some((value) => typeof value === 'string') === true ? { type: 'category', categoryorder: 'array', categoryarray: [...axis.values] } : { type: 'linear' });

/** Variants that have the figure and lie on both axes: of equal place the best stands for all, where a line is drawn through them. */
function pointsOf({ plane: { figure, across, up }, variants }: Drawing): Point[] {
  const points = variants.flatMap((variant): Point[] => {
    const measured = variant.figures[figure.name];
    const mean = meanOf(variant, figure.name);
    const x = across === null ? variant.number : variant.values[across.place];
    const y = up === null ? mean : variant.values[up.place];
    if (measured === undefined || mean === null || x === null || x === undefined || y === null || y === undefined) return [];
    return [{ variant, x, y, mean, low: measured.low, high: measured.high }];
  });
  if (across === null || across.scattered || up !== null) return points;
  const best = new Map<Value, Point>();
  const rank = ({ mean }: Point) => rankOf(mean, figure) ?? 0;
  for (const point of points) {
    const other = best.get(point.x);
    if (other === undefined || rank(point) < rank(other)) best.set(point.x, point);
  }
  return across.values.flatMap((value) => best.get(value) ?? []);
}

/** The band of the intervals, and the line through the means. */
function spread(points: readonly Point[], token: Drawing['token']): Data[] {
  const colour = token('series-measured');
  const banded = points.filter(({ low, high }) => low !== null && high !== null);
  const x = banded.map((point) => point.x);
  const edge = { type: 'scatter', mode: 'lines', line: { width: 0, color: colour }, hoverinfo: 'skip' } as const;
  return [
    { ...edge, x, y: banded.map(({ low }) => low) },
    { ...edge, x, y: banded.map(({ high }) => high), fill: 'tonexty', fillcolor: `${colour}2b` },
    { type: 'scatter', mode: 'lines', x: points.map((point) => point.x), y: points.map(({ mean }) => mean), line: { width: 2, color: colour }, hoverinfo: 'skip' },
  ];
}

/** The best value of all trials up to each. */
function bestSoFar(points: readonly Point[], figure: FigureMeaning, token: Drawing['token']): Data {
  const ordered = [...points].sort((one, other) => one.variant.number - other.variant.number);
  let best = NaN;
  const y = ordered.map(({ mean }) => {
    if (Number.isNaN(best) || (rankOf(mean, figure) ?? Infinity) < (rankOf(best, figure) ?? Infinity)) best = mean;
    return best;
  });
  const shown = figure.better === 'neither' ? [] : ordered;
  return { type: 'scatter', mode: 'lines', x: shown.map(({ variant }) => variant.number), y, line: { width: 1.5, color: token('series-wanted'), shape: 'hv' }, hoverinfo: 'skip' };
}

/** The single seeds of the points. */
function seedDots({ plane: { figure }, runs, token }: Drawing, points: readonly Point[]): Data {
  const places = new Map(points.map((point) => [point.variant.number, point.x]));
  const shown = runs.flatMap(({ variant, figures }) => {
    const [x, y] = [places.get(variant), figures[figure.name]];
    return x === undefined || y === null || y === undefined ? [] : [{ x, y }];
  });
  return { type: 'scatter', mode: 'markers', x: shown.map(({ x }) => x), y: shown.map(({ y }) => y), marker: { size: SEED, color: token('muted'), opacity: 0.55 }, hoverinfo: 'skip' };
}

function dots(points: readonly Point[], { plane: { figure, up }, best, chosen, fill, words, token }: Drawing, lined: boolean): Data {
  const measured = token('series-measured');
  const errors = points.map(({ low, mean, high }) => ({ below: low === null ? 0 : mean - low, above: high === null ? 0 : high - mean }));
  const bars = up === null && !lined ? { error_y: { type: 'data', symmetric: false, array: errors.map(({ above }) => above), arrayminus: errors.map(({ below }) => below), color: measured, thickness: 1, width: 0 } } : {};
  const data: object = {
    type: 'scatter',
    mode: 'markers',
    x: points.map(({ x }) => x),
    y: points.map(({ y }) => y),
    ...bars,
    marker: {
      size: points.map(({ variant }) => (variant.number === best ? DOT + 4 : DOT)),
      symbol: points.map(({ variant }) => (variant.number === best ? 'diamond' : 'circle')),
      color: points.map(({ mean }) => (up === null ? measured : fill(mean))),
      line: { color: points.map(({ variant }) => (variant.number === chosen ? token('text') : token('panel'))), width: points.map(({ variant }) => (variant.number === chosen ? 2 : 1)) },
    },
    customdata: points.map(({ variant }) => variant.number),
    hovertext: points.map(({ variant, mean }) => `${sweeps.variant.title(variant.number)}<br>${words(variant).replaceAll(', ', '<br>')}<br>${figure.title} ${withUnit(mean, figure)}`),
    hovertemplate: '%{hovertext}<extra></extra>',
  };
  return data;
}
