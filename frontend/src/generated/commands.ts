// Written by `make generate` from robot_runtime/contract/commands.py. Do not edit.
import type { CalibrationValues, ColourRange } from './topics';

/** Arms the robot. It is refused with every reason that stands against it. */
export interface ArmCommand {
  /** who steers: controller or pilot */
  mode?: 'automatic' | 'manual';
  /** s for which it may go on without the server */
  alone?: number;
}

/** Lets the pilot or the depth controller steer the armed robot. */
export interface ModeCommand {
  /** who steers: controller or pilot */
  mode: 'automatic' | 'manual';
}

/** Arms for some seconds and moves each fin. An event says which fins followed; then it disarms. */
export type CheckFinsCommand = Record<string, never>;

/** Acknowledges all alarms. After a failsafe the robot may be armed again from then on. */
export type AcknowledgeCommand = Record<string, never>;

/** Changes one control loop: all of it or nothing. What is left out stays as it is. */
export interface LoopCommand {
  name: 'depth' | 'heading' | 'pitch' | 'roll';
  /** steer it; in manual: hold it */
  on?: boolean | null;
  /** m, of the angles rad */
  set_point?: number | null;
  /** the controller's name */
  controller?: string | null;
  /** by name, of this or the chosen controller */
  gains?: Record<string, number>;
}

/** Sets parameters by name, all or none, between two control ticks. */
export interface ParametersCommand {
  values: Record<string, number | string | boolean>;
  /** refused where one has another value now */
  expected?: Record<string, number | string | boolean>;
  /** leave out what cannot be set, instead of refusing all */
  partly?: boolean;
}

/** Stores a calibration in the board. It is refused while the robot is armed. */
export interface CalibrateCommand {
  values: CalibrationValues;
}

/** Measures the gyroscope's offset for three seconds at rest, and stores it. An event tells the result. */
export type MeasureGyroCommand = Record<string, never>;

/** Takes the pressure now for the surface's. It is refused while the robot is armed. */
export type ZeroDepthCommand = Record<string, never>;

/** Chooses the course while the robot holds its depth. */
export interface SteeringCommand {
  /** none: stay; beacons: swim to the light that its detectors see */
  by: 'none' | 'beacons';
}

/** Holds a card before the simulated camera, or takes it away. */
export interface CardCommand {
  /** the card's; null: no card */
  colour?: string | null;
}

/** Replaces all settings of the vision node, also for later starts. None may be left out. */
export interface VisionSettingsCommand {
  rate: number;
  colour: string;
  colours: Record<string, ColourRange>;
  area_min: number;
  area_max: number;
  fill_min: number;
  aspect: [number, number];
  circularity_min: number;
  opening: number;
  confirmation: [number, number];
  white_balance: 'none' | 'grey_world' | 'underwater';
  markers: 'none' | '4x4_50' | '5x5_100' | '6x6_250' | '7x7_1000' | 'original' | 'april_36h11';
  marker_numbers: number[];
  actions: Record<string, number>;
}

/** Pauses the mission: the robot stays at its depth, and the mission's clocks stand still. */
export interface MissionPauseCommand {
  /** false: go on */
  on?: boolean;
}

/** Ends the steps of the mission that run now, as a success. */
export type MissionSkipCommand = Record<string, never>;

/** Ends the mission: its changes are put back, and the robot is stopped. */
export type MissionEndCommand = Record<string, never>;

/** The body of each command, by its name. */
export interface Commands {
  arm: ArmCommand;
  mode: ModeCommand;
  check_fins: CheckFinsCommand;
  acknowledge: AcknowledgeCommand;
  loop: LoopCommand;
  parameters: ParametersCommand;
  calibrate: CalibrateCommand;
  measure_gyro: MeasureGyroCommand;
  zero_depth: ZeroDepthCommand;
  steering: SteeringCommand;
  card: CardCommand;
  vision_settings: VisionSettingsCommand;
  mission_pause: MissionPauseCommand;
  mission_skip: MissionSkipCommand;
  mission_end: MissionEndCommand;
}
