/** A calibration in units for people, and as a file. */
import { degrees } from '../../attitude';
import { fixed } from '../../format';
import type { CalibrationValues } from '../../generated/topics';
import { system } from '../../texts/system';

const texts = system.calibration;
const { fins } = system.firmware;

/** in the order of the packet */
export const FINS = [fins.frontRight, fins.backRight, fins.backLeft, fins.frontLeft] as const;

export interface Fact {
  readonly name: string;
  readonly value: string;
  readonly unit?: string;
  readonly meaning?: string;
}

export interface Difference {
  readonly name: string;
  readonly board: string;
  readonly file: string;
}

export const sense = (reversed: boolean | undefined): string => (reversed ? texts.fins.fall : texts.fins.rise);

/** What is not of a fin. */
export function facts(values: CalibrationValues): Fact[] {
  return [
    { name: texts.axes, value: values.axes.map((axis) => axis.replace('-', '−')).join(', '), meaning: texts.axesMeaning },
    { name: texts.gyro, value: values.gyro_bias.map((rate) => fixed(degrees(rate), 2)).join(', '), unit: '°/s', meaning: texts.gyroMeaning },
    { name: texts.pressure, value: fixed(values.pressure_offset / 100, 2), unit: 'hPa', meaning: texts.pressureMeaning },
    { name: texts.battery, value: fixed(values.battery_factor, 3), meaning: texts.batteryMeaning },
    { name: texts.beacons, value: values.beacons_inverted ? texts.pinLow : texts.pinHigh, meaning: texts.beaconsMeaning },
  ];
}

/** Everything that the page shows of a calibration, one below the other. */
function listed(values: CalibrationValues): Fact[] {
  // The generated type of the steps is that of a single one in places.
  const steps = values.done as readonly string[];
  const names = Object.entries(texts.steps).flatMap(([name, words]) => (steps.includes(name) ? [words] : []));
  return [
    { name: texts.stepsDone, value: names.join(', ') || system.firmware.noFlags },
    ...FINS.flatMap((fin, index) => [
      { name: texts.fin(fin, texts.finZero), value: String(values.fin_zeros[index]) },
      { name: texts.fin(fin, texts.finEncoder), value: sense(values.encoders_reversed[index]) },
      { name: texts.fin(fin, texts.finMotor), value: sense(values.motors_reversed[index]) },
    ]),
    ...facts(values),
  ];
}

/** What a file would change, in the units shown. */
export function differences(board: CalibrationValues, file: CalibrationValues): Difference[] {
  const text = ({ value, unit }: Fact) => (unit === undefined ? value : `${value} ${unit}`);
  const there = listed(file);
  return listed(board).flatMap((fact, index) => {
    const other = there[index];
    return other === undefined || text(other) === text(fact) ? [] : [{ name: fact.name, board: text(fact), file: text(other) }];
  });
}

type Check = (value: unknown) => boolean;
const all = (length: number | null, check: Check): Check => (value) => Array.isArray(value) && (length === null || value.length === length) && value.every(check);
const number: Check = (value) => typeof value === 'number';
const flag: Check = (value) => typeof value === 'boolean';
const word: Check = (value) => typeof value === 'string';

/** The form of each field; the robot checks the values themselves. */
const FIELDS: Readonly<Record<keyof CalibrationValues, Check>> = {
  done: all(null, word),
  fin_zeros: all(4, number),
  encoders_reversed: all(4, flag),
  motors_reversed: all(4, flag),
  axes: all(3, word),
  gyro_bias: all(3, number),
  pressure_offset: number,
  battery_factor: number,
  beacons_inverted: flag,
};

export function asFile(values: CalibrationValues): string {
  return `${JSON.stringify(values, null, 2)}\n`;
}

/** The calibration in a file, or in words why there is none. */
export function readFile(text: string): { values: CalibrationValues } | { problem: string } {
  let read: Record<string, unknown>;
  try {
    read = Object(JSON.parse(text)) as Record<string, unknown>;
  } catch {
    return { problem: texts.file.noJson };
  }
  const wrong = Object.entries(FIELDS).find(([name, check]) => !check(read[name]));
  return wrong === undefined ? { values: read as unknown as CalibrationValues } : { problem: texts.file.noField(wrong[0]) };
}
