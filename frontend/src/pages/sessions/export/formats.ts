/** The formats, in the order in which they are offered. */
import type { ExportCompression, ExportFormat, NewExport } from '../../../api';
import { numberText } from '../../../number';
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

/** Why a range (s) cannot be exported; null: from the beginning, or to the end. */
export function orderProblem(start: number | null, end: number | null): string {
  return start !== null && end !== null && start >= end ? texts.exporting.endsFirst(numberText(start), numberText(end)) : '';
}

/** Whether two exports give the same file of an unchanged session; what is left out is null or empty. */
export function alike(one: Partial<NewExport>, other: Partial<NewExport>): boolean {
  const facts = ({ format, topics, columns, start, end, period, compression, spreadsheet }: Partial<NewExport>) =>
    JSON.stringify([format, topics ?? null, columns ?? null, start ?? null, end ?? null, format === 'csv-grid' ? (period ?? 0.1) : null, compression ?? 'none', spreadsheet ?? 'none']);
  return facts(one) === facts(other);
}
