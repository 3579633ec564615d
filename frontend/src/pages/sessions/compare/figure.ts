/** Sessions as a Plotly figure: charts stacked over one time axis, and on top a row of events for each session. */
import type { Compared, Comparison, SignalLine } from '../../../api';
import type { Pointed } from '../../../parts/figures';
import type { Data, Layout } from 'plotly.js-basic-dist-min';
import { chartsOf, columnWords, type Chart } from './charts';
import { compare as texts } from '../../../texts/compare';
import { notes } from '../../../texts/notes';

export interface Look {
  readonly text: string;
  readonly muted: string;
  readonly panel: string;
  readonly line: string;
  readonly band: string;
  readonly font: string;
  readonly colours: readonly string[];
}

export interface View {
  /** s on the common axis */
  readonly start: number;
  readonly end: number;
}

export interface Picture {
  readonly data: Data[];
  readonly layout: Partial<Layout>;
  /** px */
  readonly height: number;
}

/** Lines of a part of the time, by session and signal; where they are missing those of the comparison stand. */
export type Finer = ReadonlyMap<number, Readonly<Record<string, SignalLine>>>;

const LEFT = 58;
const LEFT_NARROW = 46;
const RIGHT = 10;
const BELOW = 44;
const GAP = 30;
const HIGH_FIRST = 280;
const HIGH = 170;
const ROW = 14;
const ABOVE = 8;
const MEASURED_DASHES = ['solid', 'dot', 'dashdot'];
const WANTED_DASHES = ['dash', 'longdash', 'longdashdot'];
const CLEAR = 'rgba(0,0,0,0)';
const TOLD = new Set(['armed', 'disarmed', 'fin_check', 'controller']);

/** The sessions that can be laid over each other. */
export function laid(comparison: Comparison): Compared[] {
  return comparison.sessions.filter(({ offset }) => offset !== null);
}

/** All of the time that any of the sessions has. */
export function wholeView(comparison: Comparison): View {
  const sessions = laid(comparison);
  if (sessions.length === 0) return { start: 0, end: 1 };
  return {
    start: Math.min(...sessions.map(({ offset }) => -(offset ?? 0))),
    end: Math.max(...sessions.map(({ offset, duration }) => duration - (offset ?? 0))),
  };
}

export function drawPicture(
  comparison: Comparison,
  finer: Finer,
  view: View,
  width: number,
  look: Look,
  pointed: Pointed | null = null,
): Picture {
  const sessions = laid(comparison);
  const charts = chartsOf(comparison.signals);
  const told = sessions.some((one) => toldBy(one).length > 0);
  const rows = told ? sessions.length * ROW : 0;
  const heights = charts.map((_, place) => (place === 0 ? HIGH_FIRST : HIGH));
  const inside = rows + heights.reduce((sum, high) => sum + high + GAP, 0);
  const height = ABOVE + inside + BELOW;
  const places = domains(rows, heights, inside);
  const narrow = width < 600;
  const data = [
    ...charts.flatMap((chart, place) => sessions.flatMap((one) => lines(chart, place, one, comparison, finer, look))),
    ...(told ? sessions : []).map((one, row) => eventTrace(one, row, charts.length, colourOf(comparison, one, look), look)),
  ];
  const axes: [string, object][] = charts.map((chart, place) => [`yaxis${suffix(place)}`, valueAxis(chart, places[place] ?? [0, 1], look)]);
  if (told) {
    const range = [sessions.length - 0.5, -0.5];
    const rowAxis = { domain: [1 - rows / inside, 1], range, fixedrange: true, showgrid: false, zeroline: false, showticklabels: false };
    axes.push([`yaxis${suffix(charts.length)}`, rowAxis]);
  }
  const layout = {
    ...(Object.fromEntries(axes) as Partial<Layout>),
    ...frameOf(comparison, view, look, charts.length),
    width,
    height,
    margin: { l: narrow ? LEFT_NARROW : LEFT, r: RIGHT, t: ABOVE, b: BELOW, pad: 0 },
    annotations: charts.map((chart, place) => heading(chart, places[place]?.[1] ?? 1, look, narrow)),
    shapes: [...moments(sessions, comparison, look), ...(pointed ? [pointedShape(pointed, sessions, charts, look)] : [])],
  } as unknown as Partial<Layout>;
  return { data, layout, height };
}

/** The axis of time, and how the picture looks and answers the pointer. */
function frameOf(comparison: Comparison, view: View, look: Look, charts: number) {
  const font = { family: look.font, size: 12, color: look.muted };
  return {
    xaxis: {
      range: [view.start, view.end],
      anchor: `y${suffix(charts - 1)}`,
      gridcolor: look.line,
      zeroline: true,
      zerolinecolor: look.muted,
      zerolinewidth: 1,
      showspikes: false,
      title: { text: axisTitle(comparison), standoff: 8, font },
      hoverformat: '.2f',
    },
    paper_bgcolor: CLEAR,
    plot_bgcolor: CLEAR,
    font,
    showlegend: false,
    dragmode: 'zoom',
    hovermode: 'x unified',
    hoversubplots: 'axis',
    hoverlabel: { bgcolor: look.panel, bordercolor: look.line, font: { ...font, color: look.text }, namelength: -1 },
  };
}

function axisTitle({ align }: Comparison): string {
  if (align.by === 'armed') return texts.charts.since.armed;
  if (align.by === 'segment') return texts.charts.since.segment;
  if (align.by === 'set_point') return texts.charts.since.step(align.number);
  if (align.by === 'marker') return texts.charts.since.bookmark(align.marker || notes.noText);
  if (align.by === 'mission') return texts.charts.since.mission(align.step);
  return texts.charts.since.start;
}

function suffix(place: number): string {
  return place === 0 ? '' : String(place + 1);
}

/** Lower and upper end of each chart, as shares of the figure's inside. */
function domains(rows: number, heights: readonly number[], inside: number): [number, number][] {
  let top = rows;
  return heights.map((high) => {
    const upper = top + GAP;
    top = upper + high;
    return [Math.max(0, 1 - top / inside), 1 - upper / inside];
  });
}

function colourOf(comparison: Comparison, session: Compared, look: Look): string {
  const place = comparison.sessions.indexOf(session);
  return look.colours[place % look.colours.length] ?? look.text;
}

function valueAxis(chart: Chart, domain: [number, number], look: Look) {
  return {
    domain,
    autorange: chart.downwards ? 'reversed' : true,
    fixedrange: true,
    gridcolor: look.line,
    zeroline: false,
    ticksuffix: chart.unit ? ` ${chart.unit}` : '',
    nticks: 6,
    automargin: false,
  };
}

function lines(chart: Chart, place: number, session: Compared, comparison: Comparison, finer: Finer, look: Look): Data[] {
  const counts = { wanted: 0, measured: 0 };
  return chart.signals.flatMap(({ signal, wanted }) => {
    const kind = wanted ? 'wanted' : 'measured';
    const nth = counts[kind]++;
    const line = (finer.get(session.id) ?? session.series)[signal.name];
    if (line === undefined) return [];
    const dashes = wanted ? WANTED_DASHES : MEASURED_DASHES;
    const trace: object = {
      type: 'scatter',
      mode: 'lines',
      ...points(line, session.offset ?? 0),
      xaxis: 'x',
      yaxis: `y${suffix(place)}`,
      name: chart.signals.length > 1 ? `${session.name}, ${columnWords(signal.column)}` : session.name,
      line: {
        color: colourOf(comparison, session, look),
        width: wanted ? 1.5 : 1.75,
        dash: dashes[nth % dashes.length],
        shape: wanted ? 'hv' : 'linear',
      },
      connectgaps: false,
      hovertemplate: `%{y:.4~g}${signal.unit ? ` ${signal.unit}` : ''}`,
    };
    return [trace];
  });
}

/** Each column's least and most one after the other, so that the line runs through both. */
export function points({ time, low, high }: SignalLine, offset: number): { x: number[]; y: (number | null)[] } {
  const x: number[] = [];
  const y: (number | null)[] = [];
  for (const [index, at] of time.entries()) {
    const [least, most] = [low[index] ?? null, high[index] ?? null];
    x.push(at - offset);
    y.push(least);
    if (most !== least) {
      x.push(at - offset);
      y.push(most);
    }
  }
  return { x, y };
}

/** What of a session's events and markers has a sign above the charts. */
function toldBy({ events, markers }: Compared) {
  const told = events.filter(({ kind, severity }) => TOLD.has(kind) || severity !== 'info');
  return [
    ...told.map((event) => ({ ...event, symbol: event.severity === 'info' ? 'line-ns' : 'triangle-down' })),
    ...markers.map((marker) => ({ ...marker, symbol: 'diamond' })),
  ];
}

function eventTrace(session: Compared, row: number, axis: number, colour: string, look: Look): Data {
  const told = toldBy(session);
  const trace: object = {
    type: 'scatter',
    mode: 'markers',
    x: told.map(({ time }) => time - (session.offset ?? 0)),
    y: told.map(() => row),
    text: told.map(({ text }) => text),
    xaxis: 'x',
    yaxis: `y${suffix(axis)}`,
    name: session.name,
    marker: { symbol: told.map(({ symbol }) => symbol), size: 9, color: colour, line: { width: 2, color: colour } },
    hovertemplate: '%{text}',
    hoverlabel: { bgcolor: look.panel },
  };
  return trace;
}

function heading(chart: Chart, top: number, look: Look, narrow: boolean) {
  const several = chart.signals.length > 1 && !narrow;
  const kinds = chart.signals.map(({ signal, wanted }) => texts.charts[wanted ? 'dashed' : 'solid'](columnWords(signal.column)));
  return {
    // Without tags: Plotly makes style attributes of them, which the content security policy refuses.
    text: several ? `${chart.title}  ·  ${[...new Set(kinds)].join(', ')}` : chart.title,
    xref: 'paper',
    yref: 'paper',
    x: 0,
    xanchor: 'left',
    y: top,
    yanchor: 'bottom',
    yshift: 3,
    showarrow: false,
    align: 'left',
    font: { family: look.font, size: 12, color: look.text },
  };
}

/** Markers and armings as lines from top to bottom. */
function moments(sessions: readonly Compared[], comparison: Comparison, look: Look) {
  return sessions.flatMap((session) => {
    const at = [...session.armed.flat().filter((time) => time > 0 && time < session.duration - 1e-3), ...session.markers.map(({ time }) => time)];
    return at.map((time) => ({
      type: 'line',
      xref: 'x',
      yref: 'paper',
      x0: time - (session.offset ?? 0),
      x1: time - (session.offset ?? 0),
      y0: 0,
      y1: 1,
      layer: 'below',
      opacity: 0.6,
      line: { color: colourOf(comparison, session, look), width: 1, dash: 'dot' },
    }));
  });
}

function pointedShape({ session, mark }: Pointed, sessions: readonly Compared[], charts: readonly Chart[], look: Look) {
  const offset = sessions.find(({ id }) => id === session)?.offset ?? 0;
  const depth = charts.findIndex(({ title }) => title === texts.charts.depth);
  const place = Math.max(0, depth);
  // In m: a chart of something else shows when it was alone.
  const bounded = depth >= 0 && mark.low !== null;
  return {
    type: 'rect',
    xref: 'x',
    yref: bounded ? `y${suffix(place)}` : `y${suffix(place)} domain`,
    x0: mark.start - offset,
    x1: mark.end - offset,
    y0: bounded ? mark.low : 0,
    y1: bounded ? mark.high : 1,
    layer: 'above',
    fillcolor: look.band,
    line: { color: look.text, width: 1 },
  };
}
