import { DeviceFault, ResetCause, StatusFlag } from '../../generated/topics';
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
  [DeviceFault.IMU, texts.sensors.imu],
  [DeviceFault.PRESSURE, texts.sensors.pressure],
  [DeviceFault.ENCODER_FRONT_RIGHT, texts.sensors.encoder(texts.fins.frontRight)],
  [DeviceFault.ENCODER_BACK_RIGHT, texts.sensors.encoder(texts.fins.backRight)],
  [DeviceFault.ENCODER_BACK_LEFT, texts.sensors.encoder(texts.fins.backLeft)],
  [DeviceFault.ENCODER_FRONT_LEFT, texts.sensors.encoder(texts.fins.frontLeft)],
  [DeviceFault.BRIDGE_FRONT_RIGHT, texts.sensors.bridge(texts.fins.frontRight)],
  [DeviceFault.BRIDGE_BACK_RIGHT, texts.sensors.bridge(texts.fins.backRight)],
  [DeviceFault.BRIDGE_BACK_LEFT, texts.sensors.bridge(texts.fins.backLeft)],
  [DeviceFault.BRIDGE_FRONT_LEFT, texts.sensors.bridge(texts.fins.frontLeft)],
  [DeviceFault.TRACKING_FRONT_RIGHT, texts.sensors.tracking(texts.fins.frontRight)],
  [DeviceFault.TRACKING_BACK_RIGHT, texts.sensors.tracking(texts.fins.backRight)],
  [DeviceFault.TRACKING_BACK_LEFT, texts.sensors.tracking(texts.fins.backLeft)],
  [DeviceFault.TRACKING_FRONT_LEFT, texts.sensors.tracking(texts.fins.frontLeft)],
  [DeviceFault.MAGNET, texts.sensors.magnet],
  [DeviceFault.SURFACE, texts.sensors.surface],
  [DeviceFault.LEAK, texts.sensors.leak],
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
