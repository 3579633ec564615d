/** A step of the bring-up: its kind, its place, its live readings. */
import type { RawReadings, BringUpStep } from '../../api';
import { fixed, MISSING } from '../../format';
import { bringUp } from '../../texts/bring_up';

const texts = bringUp.readings;
const DEGREES_PER_COUNT = 360 / 1024;

export type StepKind = keyof typeof bringUp.step.consequences;

/** fin_2 is of the kind `fin`, and of fin 2. */
export function kindOf(name: string): { kind: StepKind; fin: number } {
  const [stem = '', number = '0'] = name.split('_');
  return { kind: Object.hasOwn(bringUp.step.consequences, stem) ? (stem as StepKind) : 'other', fin: Number(number) };
}

/** The step that an address names, or the first that is not done. */
export function openStep(steps: readonly BringUpStep[], name: string | undefined): number {
  const named = steps.findIndex((step) => step.name === name);
  if (named >= 0) return named;
  return Math.max(0, steps.findIndex(({ state }) => state !== 'done'));
}

export interface Measured {
  readonly name: string;
  readonly value: string;
  readonly unit?: string;
}

/** What the board measures now of the parts of a step. */
export function readings(name: string, raw: RawReadings): Measured[] {
  const { kind, fin } = kindOf(name);
  const encoders = raw.encoders.map(({ counts, field }, index) => ({
    name: texts.encoder(bringUp.fins[index] ?? String(index)),
    value: field === 'silent' ? texts.silent : texts.counts(counts, fixed(counts * DEGREES_PER_COUNT, 0)),
    field: texts.magnets[field],
  }));
  const three = (values: readonly number[] | undefined, decimals: number) => values?.map((value) => fixed(value, decimals)).join(', ') ?? MISSING;
  switch (kind) {
    case 'sensors':
      return [
        ...encoders.map((encoder) => ({ name: encoder.name, value: encoder.field })),
        { name: texts.imu, value: raw.imu ? `0x${raw.imu.identity.toString(16)}` : texts.silent },
      ];
    case 'battery':
      return [{ name: texts.battery, value: fixed(raw.battery_volts, 2), unit: 'V' }];
    case 'axes':
      return [{ name: texts.force, value: three(raw.imu?.force, 2), unit: 'g' }];
    case 'gyro':
      return [{ name: texts.rate, value: three(raw.imu?.rate, 1), unit: '°/s' }];
    case 'pressure':
      return [
        { name: texts.pressure, value: fixed(raw.pressure_hpa, 1), unit: 'hPa' },
        { name: texts.temperature, value: fixed(raw.temperature, 1), unit: '°C' },
      ];
    case 'fin':
      return encoders.slice(fin, fin + 1).map(({ name, value }) => ({ name, value }));
    case 'motor':
      return encoders.map(({ name, value }) => ({ name, value }));
    case 'beacons': {
      const level = (high: boolean) => (high ? texts.high : texts.low);
      return [
        { name: texts.right, value: level(raw.beacons.right) },
        { name: texts.left, value: level(raw.beacons.left) },
      ];
    }
    case 'leak':
      return [{ name: texts.leak, value: raw.leak ? texts.wet : texts.dry }];
    default:
      return [];
  }
}
