/** The study's figures for Plotly: one signal against another, and spectra. */
import type { Data, Layout } from 'plotly.js-basic-dist-min';
import type { Signal, SignalPair, Spectrum } from '../../../api';
import { study as texts } from '../../../texts/study';
import { columnWords, DEPTHS } from '../compare/charts';

/** Fixed ends of an axis; null: as the values are. */
export interface Limits {
  readonly least: number | null;
  readonly most: number | null;
}

export interface StudyPicture {
  readonly data: Data[];
  readonly x: string;
  readonly y: string;
  /** the upward axis is logarithmic */
  readonly log: boolean;
  /** a depth, which grows downwards */
  readonly downwards: boolean;
}

export const AUTOMATIC: Limits = { least: null, most: null };
/** Tokens of the colours, in the order of the signals. */
const COLOURS = ['series-measured', 'series-third', 'series-4', 'series-5', 'series-6', 'series-7'] as const;

/** The topic and the column's words; once where both are the same. */
export const signalWords = (topic: string, words: string): string => (topic === words ? topic : `${topic}, ${words}`);

export const signalTitle = ({ topic, column, unit }: Signal): string => `${signalWords(topic, columnWords(column))}${unit === '' ? '' : ` (${unit})`}`;

/** Why these ends cannot be used; '' where they can. */
export function limitsProblem(axis: string, { least, most }: Limits, log: boolean): string {
  if (log && [least, most].some((end) => end !== null && end <= 0)) return texts.axis.positive(axis);
  return least !== null && most !== null && least >= most ? texts.axis.order(axis) : '';
}

export function drawPair(pair: SignalPair, token: (name: string) => string): StudyPicture {
  const data: Data = { type: 'scatter', mode: 'lines+markers', x: pair.x_values, y: pair.y_values, customdata: pair.time, line: { width: 1, color: token('series-measured') }, marker: { size: 3, color: token('series-measured') }, hovertemplate: '%{x:.4~g}, %{y:.4~g}<br>%{customdata:.2f} s<extra></extra>' };
  return { data: [data], x: signalTitle(pair.x), y: signalTitle(pair.y), log: false, downwards: DEPTHS.has(pair.y.name) };
}

export function drawSpectra(spectra: readonly Spectrum[], token: (name: string) => string): StudyPicture {
  const data = spectra.map(({ signal, frequency, density }, place): Data => ({ type: 'scatter', mode: 'lines', name: signalTitle(signal), x: frequency, y: density, line: { width: 1.5, color: token(spectrumColour(place)) }, hovertemplate: '%{x:.3~g} Hz: %{y:.3~g}<extra></extra>' }));
  const units = new Set(spectra.map(({ signal }) => signal.unit));
  const [unit = ''] = units;
  return { data, x: texts.spectrum.frequency, y: texts.spectrum.density(units.size > 1 || unit === '' ? texts.spectrum.anyUnit : /\W/.test(unit) ? `(${unit})` : unit), log: true, downwards: false };
}

export const spectrumColour = (place: number): string => COLOURS[place % COLOURS.length] ?? COLOURS[0];

/** The ends that an address gives as `0,1.5`, `,1.5` or `0,`; automatic where it is none of these. */
export function readLimits(text: string): Limits {
  const ends = text.split(',').map((end) => (end.trim() === '' ? null : Number(end)));
  const [least = null, most = null] = ends;
  return ends.length === 2 && ends.every((end) => end === null || Number.isFinite(end)) ? { least, most } : AUTOMATIC;
}

/** The same for the address; null where both are automatic. */
export const writeLimits = ({ least, most }: Limits): string | null => (least === null && most === null ? null : `${least ?? ''},${most ?? ''}`);

export function axisRange({ least, most }: Limits, log: boolean, downwards = false): object {
  const end = (value: number | null) => (value === null ? null : log ? Math.log10(value) : value);
  // Of a fixed range there may be less than a decade; otherwise each has its line.
  if (least === null && most === null) return { autorange: downwards ? 'reversed' : true, ...(log ? { dtick: 1 } : {}) };
  if (!downwards) return { range: [end(least), end(most)] };
  // Plotly's names of the end that it finds itself.
  return { autorange: least !== null && most !== null ? false : [least === null ? 'min' : 'max', 'reversed'].join(' '), range: [end(most), end(least)] };
}

/** How a picture looks, `width` px wide. */
export function layoutOf(picture: StudyPicture, x: Limits, y: Limits, width: number, token: (name: string) => string): Partial<Layout> {
  const font = { family: token('font'), size: 12, color: token('muted') };
  const axis = { gridcolor: token('line'), zerolinecolor: token('line'), automargin: true, fixedrange: true };
  return {
    width,
    height: width < 600 ? 300 : 380,
    margin: { l: 56, r: 12, t: 12, b: 48 },
    paper_bgcolor: token('panel'),
    plot_bgcolor: token('panel'),
    font,
    showlegend: false,
    hovermode: 'closest',
    hoverlabel: { bgcolor: token('panel'), bordercolor: token('line'), font: { ...font, color: token('text') } },
    xaxis: { ...axis, ...axisRange(x, false), title: { text: picture.x, standoff: 8, font } },
    yaxis: { ...axis, ...axisRange(y, picture.log, picture.downwards), type: picture.log ? 'log' : 'linear', exponentformat: 'e', title: { text: picture.y, standoff: 8, font } },
  } as unknown as Partial<Layout>;
}
