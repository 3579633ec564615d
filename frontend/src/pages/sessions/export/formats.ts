/** The formats, in the order in which they are offered, and what each is for. */
import type { ExportFormat } from '../../../api';

export interface Choice {
  readonly format: ExportFormat;
  readonly title: string;
  readonly text: string;
  /** what can be chosen besides: topics, or columns and a period; and whether a range */
  readonly parts: 'topics' | 'columns' | 'whole';
}

export const CHOICES: readonly Choice[] = [
  { format: 'csv', title: 'CSV, a table for each topic', text: 'For spreadsheets, MATLAB and scripts: every sample at its own time.', parts: 'topics' },
  { format: 'csv-grid', title: 'CSV, one joined table', text: 'Chosen columns side by side, a line every so many seconds.', parts: 'columns' },
  { format: 'mcap', title: 'MCAP', text: 'For Foxglove and Lichtblick: depth, attitude, camera and log at a glance.', parts: 'topics' },
  { format: 'parquet', title: 'Parquet', text: 'For pandas and other tools that take large tables: small files, exact numbers.', parts: 'topics' },
  { format: 'jsonl', title: 'JSON Lines', text: 'For programs: one object a sample, in the order of time.', parts: 'topics' },
  { format: 'report', title: 'Report', text: 'For reading and printing: charts and figures in one HTML file that needs no network.', parts: 'whole' },
  { format: 'archive', title: 'Archive', text: 'For µ-CAT on another computer, which imports it whole: replay and comparison go on there.', parts: 'whole' },
];

/** Columns of the joined table where nobody has chosen others; their topics' own clocks are rarely wanted. */
export const USUAL_COLUMNS = ['depth.depth', 'control.set_point', 'control.output', 'imu.attitude_0', 'imu.attitude_1', 'imu.attitude_2', 'imu.attitude_3', 'status.battery'];

export function titleOf(format: ExportFormat): string {
  return CHOICES.find((choice) => choice.format === format)?.title ?? format;
}

/** A number of seconds that somebody typed; null where the field is empty, NaN where it holds no number. */
export function seconds(text: string): number | null {
  return text.trim() === '' ? null : Number(text.replace(',', '.'));
}
