import { ResetCause, SensorFault, StatusFlag } from '../../generated/topics';
import { system } from '../../texts/system';

const texts = system.firmware;

const CAUSES: Record<number, string> = {
  [ResetCause.UNKNOWN]: texts.causes.unknown,
  [ResetCause.POWER_ON]: texts.causes.powerOn,
  [ResetCause.EXTERNAL]: texts.causes.external,
  [ResetCause.BROWN_OUT]: texts.causes.brownOut,
  [ResetCause.WATCHDOG]: texts.causes.watchdog,
};

const FAULTS: readonly (readonly [number, string])[] = [
  [SensorFault.IMU, texts.sensors.imu],
  [SensorFault.PRESSURE, texts.sensors.pressure],
  [SensorFault.FIN_FRONT_RIGHT, texts.sensors.finFrontRight],
  [SensorFault.FIN_BACK_RIGHT, texts.sensors.finBackRight],
  [SensorFault.FIN_BACK_LEFT, texts.sensors.finBackLeft],
  [SensorFault.FIN_FRONT_LEFT, texts.sensors.finFrontLeft],
];

const FLAGS: readonly (readonly [number, string])[] = [
  [StatusFlag.ARMED, texts.flags.armed],
  [StatusFlag.HOST_ALIVE, texts.flags.hostAlive],
  [StatusFlag.NEUTRAL, texts.flags.neutral],
  [StatusFlag.MOTOR_POWER, texts.flags.motorPower],
  [StatusFlag.BATTERY_LOW, texts.flags.batteryLow],
  [StatusFlag.DEFINITIONS_DIFFER, texts.flags.definitionsDiffer],
  [StatusFlag.HIL, texts.flags.hil],
];

export const causeWords = (cause: number): string => CAUSES[cause] ?? texts.causes.other(cause);
export const faultWords = (faults: number): string => words(faults, FAULTS);
export const flagWords = (flags: number): string => words(flags, FLAGS);

function words(bits: number, names: readonly (readonly [number, string])[]): string {
  const set = names.filter(([bit]) => (bits & bit) !== 0).map(([, name]) => name);
  return set.length > 0 ? set.join(', ') : texts.noFlags;
}
