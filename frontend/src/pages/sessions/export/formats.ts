/** The formats, in the order in which they are offered. */
import type { ExportCompression, ExportFormat } from '../../../api';
import { sessions as texts } from '../../../texts/sessions';

export interface Choice {
  readonly format: ExportFormat;
  /** what can be chosen besides: topics, or columns and a period; and whether a range */
  readonly parts: 'topics' | 'columns' | 'whole';
}

export const CHOICES: readonly Choice[] = [
  { format: 'csv', parts: 'topics' },
  { format: 'csv-grid', parts: 'columns' },
  { format: 'mcap', parts: 'topics' },
  { format: 'parquet', parts: 'topics' },
  { format: 'jsonl', parts: 'topics' },
  { format: 'report', parts: 'whole' },
  { format: 'archive', parts: 'whole' },
];

/** Of MCAP, the smallest file last. */
export const COMPRESSIONS: readonly ExportCompression[] = ['none', 'lz4', 'zstd'];

/** Columns of the joined table where nobody has chosen others; their topics' own clocks are rarely wanted. */
export const USUAL_COLUMNS = ['depth.depth', 'control.set_point', 'control.output', 'imu.attitude_0', 'imu.attitude_1', 'imu.attitude_2', 'imu.attitude_3', 'status.battery'];

export function titleOf(format: ExportFormat): string {
  return texts.exporting.formats[format].title;
}

/** A number of seconds that somebody typed; null where the field is empty, NaN where it holds no number. */
export function seconds(text: string): number | null {
  return text.trim() === '' ? null : Number(text.replace(',', '.'));
}
