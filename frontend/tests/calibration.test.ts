import { expect, test } from 'vitest';
import type { CalibrationValues } from '../src/generated/topics';
import { asFile, differences, facts, readFile } from '../src/pages/system/calibration';

const VALUES = {
  done: ['fins', 'motors', 'axes', 'gyro', 'pressure', 'battery', 'beacons'],
  fin_zeros: [188, 161, 726, 356],
  encoders_reversed: [true, true, false, false],
  motors_reversed: [true, true, true, true],
  axes: ['x', '-y', '-z'],
  gyro_bias: [Math.PI / 180, -Math.PI / 360, 0],
  pressure_offset: -250,
  battery_factor: 1.02,
  beacons_inverted: true,
} as unknown as CalibrationValues;

test('a calibration is shown in units for people', () => {
  expect(facts(VALUES).map(({ value, unit }) => `${value} ${unit ?? ''}`.trim())).toEqual(['x, −y, −z', '1.00, −0.50, 0.00 °/s', '−2.50 hPa', '1.020', 'low']);
});

test('a file holds all of it', () => {
  expect(readFile(asFile(VALUES))).toEqual({ values: VALUES });
});

test('only what a file would change is listed', () => {
  expect(differences(VALUES, VALUES)).toEqual([]);
  const other = { ...VALUES, done: ['fins'], fin_zeros: [188, 161, 700, 356], pressure_offset: 0 } as unknown as CalibrationValues;
  expect(differences(VALUES, other)).toEqual([
    { name: 'Steps done', board: 'fins, motors, axes, gyroscope, pressure, battery, beacons', file: 'fins' },
    { name: 'Fin back left: zero', board: '726', file: '700' },
    { name: 'Pressure sensor', board: '−2.50 hPa', file: '0.00 hPa' },
  ]);
});

test.each([
  ['fins: 3', 'it is not JSON'],
  ['null', '“done”'],
  ['[1]', '“done”'],
  [JSON.stringify({ ...VALUES, fin_zeros: [1, 2, 3] }), '“fin_zeros”'],
  [JSON.stringify({ ...VALUES, axes: ['x', 2, 'z'] }), '“axes”'],
  [JSON.stringify({ ...VALUES, battery_factor: '1.0' }), '“battery_factor”'],
])('a file with %s is refused in words', (text, words) => {
  const read = readFile(text);
  expect('problem' in read && read.problem).toContain(words);
});
