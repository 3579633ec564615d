/**
 * Heat maps as a Plotly figure: one facet for each baud, in it a bar for each cell.
 *
 * Bars, since Plotly's own heat map is a picture at a data: address, for which the content security policy has no
 * room; and since a bar carries its number and its colour exactly as the page's other cells do.
 */
import type { Data, Layout } from 'plotly.js-basic-dist-min';
import { facetColumns, gridOf, key, placeWords, type Grid, type Place } from './grid';
import type { Paint } from '../../parts/table';
import { commTests as texts } from '../../texts/comm_tests';

export interface FigureCell {
  readonly place: Place;
  /** printed in the cell */
  readonly text: string;
  readonly paint: Paint;
}

export interface Look {
  readonly text: string;
  readonly muted: string;
  readonly panel: string;
  readonly line: string;
  readonly font: string;
  /** px: as high as a finger needs, where fingers choose */
  readonly cellHigh: number;
}

export interface Figure {
  readonly data: Data[];
  readonly layout: Partial<Layout>;
  /** px */
  readonly height: number;
}

const CELL_WIDE = 44;
const LEFT = 48;
/** of a facet's baud and, below it, the Pi's delays */
const HEAD = 46;
const TICKS = 20;
const BELOW = 12;
const GAP = 18;
/** px left between cells */
const SEAM = 2;
/** px below which a cell has no room for its number */
const TEXT_LEAST = 30;
const CLEAR = 'rgba(0,0,0,0)';

/** Where a facet lies. `x` and `y` are shares of the figure's inside, counted from its lower left. */
interface Facet {
  readonly baud: number;
  /** what Plotly adds to the names of its axes: nothing, 2, 3 and so on */
  readonly suffix: string;
  readonly leftmost: boolean;
  readonly x: readonly [number, number];
  readonly y: readonly [number, number];
  /** px */
  readonly cellWide: number;
}

/** The figure of `cells` in `width` px, with the cell at `chosen` (a key) framed. */
export function drawFigure(cells: readonly FigureCell[], width: number, chosen: string, look: Look): Figure {
  const grid = gridOf(cells.map(({ place }) => place));
  const { facets, height } = layOut(grid, width, look.cellHigh);
  const axes = facets.flatMap((facet) => [
    [`xaxis${facet.suffix}`, acrossAxis(facet, grid)],
    [`yaxis${facet.suffix}`, downAxis(facet, grid)],
  ]);
  const font = { family: look.font, size: 13, color: look.text };
  const layout: Partial<Layout> = {
    ...(Object.fromEntries(axes) as Partial<Layout>),
    width,
    height,
    margin: { l: LEFT, r: 0, t: 0, b: 0, pad: 0 },
    paper_bgcolor: CLEAR,
    plot_bgcolor: CLEAR,
    font: { ...font, size: 12, color: look.muted },
    showlegend: false,
    dragmode: false,
    hovermode: 'closest',
    hoverlabel: { bgcolor: look.panel, bordercolor: look.line, font },
    barmode: 'overlay',
    annotations: facets.map(({ baud, x, y }) => ({
      text: texts.baud(baud),
      xref: 'paper',
      yref: 'paper',
      x: (x[0] + x[1]) / 2,
      xanchor: 'center',
      y: y[1],
      yanchor: 'bottom',
      yshift: TICKS,
      showarrow: false,
      font,
    })),
  };
  const data = facets.map((facet) =>
    bars(facet, grid, cells.filter(({ place }) => place.baud === facet.baud), chosen, look),
  );
  return { data, layout, height };
}

function layOut({ bauds, arduinoDelays, piDelays }: Grid, width: number, cellHigh: number): { facets: Facet[]; height: number } {
  const inside = Math.max(1, width - LEFT);
  const columns = facetColumns(bauds.length, inside, piDelays.length * CELL_WIDE, GAP);
  const wide = (inside - (columns - 1) * GAP) / columns;
  const high = arduinoDelays.length * cellHigh;
  const row = HEAD + high + BELOW;
  const height = Math.ceil(bauds.length / columns) * row;
  const facets = bauds.map((baud, index): Facet => {
    const left = (index % columns) * (wide + GAP);
    const top = Math.floor(index / columns) * row + HEAD;
    return {
      baud,
      suffix: index === 0 ? '' : String(index + 1),
      leftmost: index % columns === 0,
      x: [left / inside, (left + wide) / inside],
      y: [1 - (top + high) / height, 1 - top / height],
      cellWide: wide / piDelays.length,
    };
  });
  return { facets, height };
}

const AXIS = { zeroline: false, showgrid: false, fixedrange: true, ticks: '', automargin: false } as const;

function acrossAxis({ suffix, x, cellWide }: Facet, { piDelays }: Grid) {
  return {
    ...AXIS,
    domain: x,
    anchor: `y${suffix}`,
    side: 'top',
    range: [-0.5, piDelays.length - 0.5],
    tickvals: piDelays.map((_, at) => at),
    ticktext: piDelays.map((delay) => (cellWide < TEXT_LEAST ? String(delay) : texts.delay(delay))),
    tickangle: 0,
  };
}

function downAxis({ suffix, y, leftmost }: Facet, { arduinoDelays }: Grid) {
  return {
    ...AXIS,
    domain: y,
    anchor: `x${suffix}`,
    range: [arduinoDelays.length - 0.5, -0.5],
    tickvals: arduinoDelays.map((_, at) => at),
    ticktext: arduinoDelays.map(texts.delay),
    showticklabels: leftmost,
  };
}

function bars(facet: Facet, grid: Grid, cells: readonly FigureCell[], chosen: string, look: Look): Data {
  const { suffix, cellWide } = facet;
  const { cellHigh } = look;
  const framed = cells.map(({ place }) => key(place) === chosen);
  const bar: object = {
    type: 'bar',
    xaxis: `x${suffix}`,
    yaxis: `y${suffix}`,
    x: cells.map(({ place }) => grid.piDelays.indexOf(place.pi_delay)),
    base: cells.map(({ place }) => grid.arduinoDelays.indexOf(place.arduino_delay) - 0.5 + SEAM / 2 / cellHigh),
    y: cells.map(() => 1 - SEAM / cellHigh),
    width: cells.map(() => 1 - SEAM / cellWide),
    marker: {
      color: cells.map(({ paint }) => paint.fill),
      line: { color: framed.map((yes) => (yes ? look.text : CLEAR)), width: framed.map((yes) => (yes ? 3 : 0)) },
    },
    text: cells.map(({ text }) => (cellWide < TEXT_LEAST ? '' : text)),
    textposition: 'inside',
    insidetextanchor: 'middle',
    insidetextfont: { size: 13, color: cells.map(({ paint }) => paint.ink) },
    textangle: 0,
    constraintext: 'none',
    cliponaxis: false,
    customdata: cells.map(({ place }) => key(place)),
    hovertext: cells.map(({ place, text }) => `${placeWords(place)}<br>${text}`),
    hovertemplate: '%{hovertext}<extra></extra>',
  };
  return bar;
}
