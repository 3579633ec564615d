import { ResetCause, SensorFault, StatusFlag } from '../../generated/topics';

const CAUSES: Record<number, string> = {
  [ResetCause.UNKNOWN]: 'unknown',
  [ResetCause.POWER_ON]: 'power was switched on',
  [ResetCause.EXTERNAL]: 'reset pin',
  [ResetCause.BROWN_OUT]: 'supply voltage fell too low',
  [ResetCause.WATCHDOG]: 'watchdog: the main loop hung',
};

const FAULTS: readonly (readonly [number, string])[] = [
  [SensorFault.IMU, 'inertial sensor'],
  [SensorFault.PRESSURE, 'pressure sensor'],
  [SensorFault.FIN_FRONT_RIGHT, 'front right fin'],
  [SensorFault.FIN_BACK_RIGHT, 'back right fin'],
  [SensorFault.FIN_BACK_LEFT, 'back left fin'],
  [SensorFault.FIN_FRONT_LEFT, 'front left fin'],
];

const FLAGS: readonly (readonly [number, string])[] = [
  [StatusFlag.ARMED, 'armed'],
  [StatusFlag.HOST_ALIVE, 'hears the runtime'],
  [StatusFlag.NEUTRAL, 'fins return to neutral'],
  [StatusFlag.MOTOR_POWER, 'motor power on'],
  [StatusFlag.BATTERY_LOW, 'battery low'],
  [StatusFlag.DEFINITIONS_DIFFER, 'definitions differ'],
  [StatusFlag.HIL, 'hardware in the loop'],
];

export const causeWords = (cause: number): string => CAUSES[cause] ?? `cause ${cause}`;
export const faultWords = (faults: number): string => words(faults, FAULTS);
export const flagWords = (flags: number): string => words(flags, FLAGS);

function words(bits: number, names: readonly (readonly [number, string])[]): string {
  const set = names.filter(([bit]) => (bits & bit) !== 0).map(([, name]) => name);
  return set.length > 0 ? set.join(', ') : 'none';
}
