/** The formats, in the order in which they are offered. */
import type { ExportCompression, ExportFormat, ExportOverlay, ExportSpreadsheet, NewExport } from '../../../api';
import { numberText } from '../../../number';
import { sessions as texts } from '../../../texts/sessions';

export interface Choice {
  readonly format: ExportFormat;
  /** what can be chosen besides: topics, or columns and a period, with a range; or a range alone; or nothing */
  readonly parts: 'topics' | 'columns' | 'range' | 'whole';
}

export const CHOICES: readonly Choice[] = [
  { format: 'csv', parts: 'topics' },
  { format: 'csv-grid', parts: 'columns' },
  { format: 'xlsx', parts: 'topics' },
  { format: 'mcap', parts: 'topics' },
  { format: 'parquet', parts: 'topics' },
  { format: 'report', parts: 'whole' },
  { format: 'archive', parts: 'whole' },
  { format: 'mp4', parts: 'range' },
];

/** Who reads the CSV: programs, or a spreadsheet with this decimal sign. */
export const READERS: readonly ExportSpreadsheet[] = ['none', 'point', 'comma'];

/** Lines that a sheet of Excel or LibreOffice holds, with the header. */
export const SHEET_LINES = 1_048_576;

interface Length {
  readonly name: string;
  readonly lines: number;
}

/** The longest table, where a sheet does not hold it; lines are estimated from the share of the session. */
export function findTooLong(tables: readonly Length[], duration: number, start: number | null, end: number | null): Length | null {
  const range = Math.max(0, Math.min(end ?? duration, duration) - Math.max(start ?? 0, 0));
  const share = duration > 0 ? range / duration : 1;
  const [longest] = tables.map(({ name, lines }) => ({ name, lines: Math.ceil(lines * share) + 1 })).sort((one, other) => other.lines - one.lines);
  return longest !== undefined && longest.lines > SHEET_LINES ? longest : null;
}

/** Of MCAP, the smallest file last. */
export const COMPRESSIONS: readonly ExportCompression[] = ['none', 'lz4', 'zstd'];

/** Over a film. */
export const OVERLAYS: readonly ExportOverlay[] = ['none', 'subtitles', 'lines'];

/** Columns of the joined table where nobody has chosen others; their topics' own clocks are rarely wanted. */
export const USUAL_COLUMNS = ['depth.depth', 'control.set_point', 'control.output', 'imu.attitude_0', 'imu.attitude_1', 'imu.attitude_2', 'imu.attitude_3', 'status.battery'];

export function titleOf({ format, overlay = 'none' }: Pick<NewExport, 'format' | 'overlay'>): string {
  const { formats, overlays } = texts.exporting;
  return overlay === 'none' ? formats[format].title : `${formats[format].title}, ${overlays[overlay].title.toLowerCase()}`;
}

/** Why a range (s) cannot be exported; null: from the beginning, or to the end. */
export function orderProblem(start: number | null, end: number | null): string {
  return start !== null && end !== null && start >= end ? texts.exporting.endsFirst(numberText(start), numberText(end)) : '';
}

/** Whether two exports give the same file of an unchanged session; what is left out is null or empty. */
export function alike(one: Partial<NewExport>, other: Partial<NewExport>): boolean {
  const facts = ({ format, topics, columns, start, end, period, compression, spreadsheet, overlay }: Partial<NewExport>) =>
    JSON.stringify([format, topics ?? null, columns ?? null, start ?? null, end ?? null, format === 'csv-grid' ? (period ?? 0.1) : null, compression ?? 'none', spreadsheet ?? 'none', overlay ?? 'none']);
  return facts(one) === facts(other);
}
