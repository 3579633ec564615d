// Written by `make generate` from robot_runtime/contract/topics.py and what it names. Do not edit.

/** What the page was built for; the server says its own, and the page asks for a reload where they differ. */
export const DEFINITIONS_HASH = '718dde94';

export type Code = 'b' | 'B' | 'h' | 'H' | 'i' | 'I' | 'f' | 'd';

/** One field of a row: `offset` counts from the row's first byte; the first eight are the time (f64, s). */
export interface Field {
  readonly name: string;
  readonly code: Code;
  readonly offset: number;
  readonly count: number;
  readonly scale: number;
  readonly unit: string;
  readonly meaning: string;
}

export interface RowTopic {
  readonly id: number;
  readonly name: string;
  readonly rowBytes: number;
  readonly meaning: string;
  readonly fields: readonly Field[];
}

export const DebugLevel = {
  DEBUG: 0,
  INFO: 1,
  WARNING: 2,
  ERROR: 3,
} as const;

export const StatusFlag = {
  ARMED: 1,
  HOST_ALIVE: 2,
  NEUTRAL: 4,
  MOTOR_POWER: 8,
  BATTERY_LOW: 16,
  DEFINITIONS_DIFFER: 32,
  HIL: 64,
} as const;

export const DeviceFault = {
  IMU: 1,
  PRESSURE: 2,
  ENCODER_FRONT_RIGHT: 4,
  ENCODER_BACK_RIGHT: 8,
  ENCODER_BACK_LEFT: 16,
  ENCODER_FRONT_LEFT: 32,
  BRIDGE_FRONT_RIGHT: 64,
  BRIDGE_BACK_RIGHT: 128,
  BRIDGE_BACK_LEFT: 256,
  BRIDGE_FRONT_LEFT: 512,
  TRACKING_FRONT_RIGHT: 1024,
  TRACKING_BACK_RIGHT: 2048,
  TRACKING_BACK_LEFT: 4096,
  TRACKING_FRONT_LEFT: 8192,
  MAGNET: 16384,
  SURFACE: 32768,
  LEAK: 65536,
} as const;

export const ResetCause = {
  UNKNOWN: 0,
  POWER_ON: 1,
  EXTERNAL: 2,
  BROWN_OUT: 3,
  WATCHDOG: 4,
} as const;

export const CalibrationStep = {
  FINS: 1,
  MOTORS: 2,
  AXES: 4,
  GYRO: 8,
  PRESSURE: 16,
  BATTERY: 32,
  BEACONS: 64,
} as const;

export const BoardEventKind = {
  BOOT: 0,
  ARMED: 1,
  REFUSED: 2,
  DISARMED: 3,
  BATTERY: 4,
  FAULT: 5,
  FAULT_OVER: 6,
} as const;

export const Refusal = {
  NONE: 0,
  NO_HELLO: 1,
  DEFINITIONS: 2,
  EPOCH: 3,
  TRAFFIC: 4,
  BATTERY: 5,
  CALIBRATION: 6,
  SURFACE: 7,
  LEAK: 8,
} as const;

export const Disarming = {
  NONE: 0,
  STOP: 1,
  SILENCE: 2,
  BATTERY: 3,
  DEFINITIONS: 4,
  HOST: 5,
  LEAK: 6,
} as const;

export const ROW_TOPICS = {
  imu: {
    id: 1,
    name: 'imu',
    rowBytes: 32,
    meaning: 'attitude, turn rate and specific force',
    fields: [
      { name: 'board_time', code: 'I', offset: 8, count: 1, scale: 1, unit: 'µs', meaning: 'the board\'s own clock, which wraps after 71 minutes' },
      { name: 'attitude', code: 'h', offset: 12, count: 4, scale: 6.103515625e-05, unit: '', meaning: 'unit quaternion w, x, y, z that turns body into world' },
      { name: 'rate', code: 'h', offset: 20, count: 3, scale: 0.00026632423, unit: 'rad/s', meaning: 'turn rate (65.5 counts per °/s)' },
      { name: 'force', code: 'h', offset: 26, count: 3, scale: 0.0011971008, unit: 'm/s²', meaning: 'specific force (8192 counts per g)' },
    ],
  },
  depth: {
    id: 2,
    name: 'depth',
    rowBytes: 20,
    meaning: 'depth and pressure',
    fields: [
      { name: 'board_time', code: 'I', offset: 8, count: 1, scale: 1, unit: 'µs', meaning: 'the board\'s own clock, which wraps after 71 minutes' },
      { name: 'depth', code: 'h', offset: 12, count: 1, scale: 0.001, unit: 'm', meaning: 'depth below the surface, downwards' },
      { name: 'pressure', code: 'I', offset: 14, count: 1, scale: 1, unit: 'Pa', meaning: 'absolute pressure' },
      { name: 'temperature', code: 'h', offset: 18, count: 1, scale: 0.01, unit: '°C', meaning: 'temperature of the water' },
    ],
  },
  beacon: {
    id: 3,
    name: 'beacon',
    rowBytes: 14,
    meaning: 'light-beacon detectors',
    fields: [
      { name: 'board_time', code: 'I', offset: 8, count: 1, scale: 1, unit: 'µs', meaning: 'the board\'s own clock, which wraps after 71 minutes' },
      { name: 'right', code: 'B', offset: 12, count: 1, scale: 1, unit: '', meaning: '1 while the right detector sees the beacon' },
      { name: 'left', code: 'B', offset: 13, count: 1, scale: 1, unit: '', meaning: '1 while the left detector sees the beacon' },
    ],
  },
  motor: {
    id: 4,
    name: 'motor',
    rowBytes: 32,
    meaning: 'fins: set points, angles, drives',
    fields: [
      { name: 'board_time', code: 'I', offset: 8, count: 1, scale: 1, unit: 'µs', meaning: 'the board\'s own clock, which wraps after 71 minutes' },
      { name: 'wanted', code: 'h', offset: 12, count: 4, scale: 0.001, unit: 'rad', meaning: 'commanded fin angle' },
      { name: 'angle', code: 'h', offset: 20, count: 4, scale: 0.001, unit: 'rad', meaning: 'measured fin angle' },
      { name: 'drive', code: 'b', offset: 28, count: 4, scale: 1, unit: '', meaning: 'H-bridge command, -63 to 63' },
    ],
  },
  status: {
    id: 5,
    name: 'status',
    rowBytes: 34,
    meaning: 'the board\'s state and health',
    fields: [
      { name: 'board_time', code: 'I', offset: 8, count: 1, scale: 1, unit: 'µs', meaning: 'the board\'s own clock, which wraps after 71 minutes' },
      { name: 'epoch', code: 'H', offset: 12, count: 1, scale: 1, unit: '', meaning: 'epoch of the board\'s boot' },
      { name: 'flags', code: 'B', offset: 14, count: 1, scale: 1, unit: '', meaning: 'see StatusFlag' },
      { name: 'faults', code: 'I', offset: 15, count: 1, scale: 1, unit: '', meaning: 'see DeviceFault' },
      { name: 'reset_cause', code: 'B', offset: 19, count: 1, scale: 1, unit: '', meaning: 'see ResetCause' },
      { name: 'battery', code: 'H', offset: 20, count: 1, scale: 0.001, unit: 'V', meaning: 'battery voltage' },
      { name: 'loop_worst', code: 'H', offset: 22, count: 1, scale: 1, unit: 'µs', meaning: 'longest pass of the main loop since the last status' },
      { name: 'missed_ticks', code: 'H', offset: 24, count: 1, scale: 1, unit: '', meaning: 'passes of the main loop missed since the start' },
      { name: 'frames_invalid', code: 'H', offset: 26, count: 1, scale: 1, unit: '', meaning: 'invalid frames dropped since the start' },
      { name: 'bytes_lost', code: 'H', offset: 28, count: 1, scale: 1, unit: '', meaning: 'received bytes lost to a full buffer since the start' },
      { name: 'debug_lost', code: 'H', offset: 30, count: 1, scale: 1, unit: '', meaning: 'events and lines lost to a full buffer since the start' },
      { name: 'stack_free', code: 'H', offset: 32, count: 1, scale: 1, unit: 'B', meaning: 'memory that the stack has never used' },
    ],
  },
  navigation: {
    id: 6,
    name: 'navigation',
    rowBytes: 14,
    meaning: 'navigation commands sent to the board',
    fields: [
      { name: 'x', code: 'b', offset: 8, count: 1, scale: 0.007874015748031496, unit: '', meaning: 'forwards' },
      { name: 'y', code: 'b', offset: 9, count: 1, scale: 0.007874015748031496, unit: '', meaning: 'to the right' },
      { name: 'z', code: 'b', offset: 10, count: 1, scale: 0.007874015748031496, unit: '', meaning: 'downwards' },
      { name: 'roll', code: 'b', offset: 11, count: 1, scale: 0.007874015748031496, unit: '', meaning: 'right side down' },
      { name: 'pitch', code: 'b', offset: 12, count: 1, scale: 0.007874015748031496, unit: '', meaning: 'nose up' },
      { name: 'yaw', code: 'b', offset: 13, count: 1, scale: 0.007874015748031496, unit: '', meaning: 'to the right' },
    ],
  },
  control: {
    id: 7,
    name: 'control',
    rowBytes: 28,
    meaning: 'ticks of the control node',
    fields: [
      { name: 'set_point', code: 'f', offset: 8, count: 1, scale: 1, unit: 'm', meaning: 'depth set point' },
      { name: 'depth', code: 'f', offset: 12, count: 1, scale: 1, unit: 'm', meaning: 'depth that the controller used' },
      { name: 'error', code: 'f', offset: 16, count: 1, scale: 1, unit: 'm', meaning: 'set point minus depth' },
      { name: 'output', code: 'f', offset: 20, count: 1, scale: 1, unit: '', meaning: 'vertical command, -1 to 1, downwards' },
      { name: 'latency', code: 'f', offset: 24, count: 1, scale: 1, unit: 's', meaning: 'age of the depth when it was used' },
    ],
  },
  link: {
    id: 8,
    name: 'link',
    rowBytes: 74,
    meaning: 'the serial link',
    fields: [
      { name: 'bytes_received', code: 'I', offset: 8, count: 1, scale: 1, unit: 'B', meaning: 'received' },
      { name: 'bytes_sent', code: 'I', offset: 12, count: 1, scale: 1, unit: 'B', meaning: 'sent' },
      { name: 'bytes_delivered', code: 'I', offset: 16, count: 1, scale: 1, unit: 'B', meaning: 'received payloads that were passed on' },
      { name: 'frames_received', code: 'I', offset: 20, count: 1, scale: 1, unit: '', meaning: 'valid frames received' },
      { name: 'frames_sent', code: 'I', offset: 24, count: 1, scale: 1, unit: '', meaning: 'frames sent' },
      { name: 'frames_invalid', code: 'I', offset: 28, count: 1, scale: 1, unit: '', meaning: 'frames dropped: garbage, wrong checksum or length' },
      { name: 'frames_missed', code: 'I', offset: 32, count: 1, scale: 1, unit: '', meaning: 'unreliable frames that their numbers show to be missing' },
      { name: 'frames_repeated', code: 'I', offset: 36, count: 1, scale: 1, unit: '', meaning: 'reliable frames sent again' },
      { name: 'frames_duplicate', code: 'I', offset: 40, count: 1, scale: 1, unit: '', meaning: 'frames that came again and were not passed on again' },
      { name: 'messages_discarded', code: 'I', offset: 44, count: 1, scale: 1, unit: '', meaning: 'unacknowledged messages to a board that restarted' },
      { name: 'round_trip', code: 'f', offset: 48, count: 1, scale: 1, unit: 's', meaning: 'time from a frame to its acknowledgement' },
      { name: 'round_trip_deviation', code: 'f', offset: 52, count: 1, scale: 1, unit: 's', meaning: 'mean deviation of the round trip' },
      { name: 'timeout', code: 'f', offset: 56, count: 1, scale: 1, unit: 's', meaning: 'wait for an acknowledgement before sending again' },
      { name: 'goodput', code: 'f', offset: 60, count: 1, scale: 1, unit: 'B/s', meaning: 'received payloads in the last second' },
      { name: 'credit', code: 'H', offset: 64, count: 1, scale: 1, unit: 'B', meaning: 'bytes that the board can take in at once' },
      { name: 'clock_error', code: 'f', offset: 66, count: 1, scale: 1, unit: 's', meaning: 'standard deviation of the board\'s mapped time' },
      { name: 'clock_drift', code: 'f', offset: 70, count: 1, scale: 1, unit: '', meaning: 'how much the board\'s clock is slow, as a share' },
    ],
  },
  truth: {
    id: 9,
    name: 'truth',
    rowBytes: 76,
    meaning: 'the simulated body',
    fields: [
      { name: 'position', code: 'f', offset: 8, count: 3, scale: 1, unit: 'm', meaning: 'north, east, down' },
      { name: 'attitude', code: 'f', offset: 20, count: 4, scale: 1, unit: '', meaning: 'unit quaternion w, x, y, z, body to world' },
      { name: 'velocity', code: 'f', offset: 36, count: 3, scale: 1, unit: 'm/s', meaning: 'in body axes' },
      { name: 'rate', code: 'f', offset: 48, count: 3, scale: 1, unit: 'rad/s', meaning: 'in body axes' },
      { name: 'fins', code: 'f', offset: 60, count: 4, scale: 1, unit: 'rad', meaning: 'fin angles' },
    ],
  },
  turning: {
    id: 10,
    name: 'turning',
    rowBytes: 44,
    meaning: 'the same ticks, for heading, pitch and roll',
    fields: [
      { name: 'set_point', code: 'f', offset: 8, count: 3, scale: 1, unit: 'rad', meaning: 'set points of heading, pitch, roll; NaN while not controlled' },
      { name: 'measured', code: 'f', offset: 20, count: 3, scale: 1, unit: 'rad', meaning: 'heading, pitch, roll' },
      { name: 'output', code: 'f', offset: 32, count: 3, scale: 1, unit: '', meaning: 'commands yaw, pitch, roll, -1 to 1; NaN while not controlled' },
    ],
  },
  track: {
    id: 11,
    name: 'track',
    rowBytes: 24,
    meaning: 'the way by dead reckoning, with its uncertainty',
    fields: [
      { name: 'x', code: 'f', offset: 8, count: 1, scale: 1, unit: 'm', meaning: 'along heading 0' },
      { name: 'y', code: 'f', offset: 12, count: 1, scale: 1, unit: 'm', meaning: 'along heading 90°' },
      { name: 'deviation_x', code: 'f', offset: 16, count: 1, scale: 1, unit: 'm', meaning: 'standard deviation of x' },
      { name: 'deviation_y', code: 'f', offset: 20, count: 1, scale: 1, unit: 'm', meaning: 'standard deviation of y' },
    ],
  },
} as const;

export interface ImuRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** µs, the board's own clock, which wraps after 71 minutes */
  board_time: number;
  /** unit quaternion w, x, y, z that turns body into world */
  attitude: number[];
  /** rad/s, turn rate (65.5 counts per °/s) */
  rate: number[];
  /** m/s², specific force (8192 counts per g) */
  force: number[];
}

export interface DepthRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** µs, the board's own clock, which wraps after 71 minutes */
  board_time: number;
  /** m, depth below the surface, downwards */
  depth: number;
  /** Pa, absolute pressure */
  pressure: number;
  /** °C, temperature of the water */
  temperature: number;
}

export interface BeaconRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** µs, the board's own clock, which wraps after 71 minutes */
  board_time: number;
  /** 1 while the right detector sees the beacon */
  right: number;
  /** 1 while the left detector sees the beacon */
  left: number;
}

export interface MotorRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** µs, the board's own clock, which wraps after 71 minutes */
  board_time: number;
  /** rad, commanded fin angle */
  wanted: number[];
  /** rad, measured fin angle */
  angle: number[];
  /** H-bridge command, -63 to 63 */
  drive: number[];
}

export interface StatusRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** µs, the board's own clock, which wraps after 71 minutes */
  board_time: number;
  /** epoch of the board's boot */
  epoch: number;
  /** see StatusFlag */
  flags: number;
  /** see DeviceFault */
  faults: number;
  /** see ResetCause */
  reset_cause: number;
  /** V, battery voltage */
  battery: number;
  /** µs, longest pass of the main loop since the last status */
  loop_worst: number;
  /** passes of the main loop missed since the start */
  missed_ticks: number;
  /** invalid frames dropped since the start */
  frames_invalid: number;
  /** received bytes lost to a full buffer since the start */
  bytes_lost: number;
  /** events and lines lost to a full buffer since the start */
  debug_lost: number;
  /** B, memory that the stack has never used */
  stack_free: number;
}

export interface NavigationRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** forwards */
  x: number;
  /** to the right */
  y: number;
  /** downwards */
  z: number;
  /** right side down */
  roll: number;
  /** nose up */
  pitch: number;
  /** to the right */
  yaw: number;
}

export interface ControlRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** m, depth set point */
  set_point: number;
  /** m, depth that the controller used */
  depth: number;
  /** m, set point minus depth */
  error: number;
  /** vertical command, -1 to 1, downwards */
  output: number;
  /** s, age of the depth when it was used */
  latency: number;
}

export interface LinkRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** B, received */
  bytes_received: number;
  /** B, sent */
  bytes_sent: number;
  /** B, received payloads that were passed on */
  bytes_delivered: number;
  /** valid frames received */
  frames_received: number;
  /** frames sent */
  frames_sent: number;
  /** frames dropped: garbage, wrong checksum or length */
  frames_invalid: number;
  /** unreliable frames that their numbers show to be missing */
  frames_missed: number;
  /** reliable frames sent again */
  frames_repeated: number;
  /** frames that came again and were not passed on again */
  frames_duplicate: number;
  /** unacknowledged messages to a board that restarted */
  messages_discarded: number;
  /** s, time from a frame to its acknowledgement */
  round_trip: number;
  /** s, mean deviation of the round trip */
  round_trip_deviation: number;
  /** s, wait for an acknowledgement before sending again */
  timeout: number;
  /** B/s, received payloads in the last second */
  goodput: number;
  /** B, bytes that the board can take in at once */
  credit: number;
  /** s, standard deviation of the board's mapped time */
  clock_error: number;
  /** how much the board's clock is slow, as a share */
  clock_drift: number;
}

export interface TruthRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** m, north, east, down */
  position: number[];
  /** unit quaternion w, x, y, z, body to world */
  attitude: number[];
  /** m/s, in body axes */
  velocity: number[];
  /** rad/s, in body axes */
  rate: number[];
  /** rad, fin angles */
  fins: number[];
}

export interface TurningRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** rad, set points of heading, pitch, roll; NaN while not controlled */
  set_point: number[];
  /** rad, heading, pitch, roll */
  measured: number[];
  /** commands yaw, pitch, roll, -1 to 1; NaN while not controlled */
  output: number[];
}

export interface TrackRow {
  /** s, steady clock of the robot's computer */
  time: number;
  /** m, along heading 0 */
  x: number;
  /** m, along heading 90° */
  y: number;
  /** m, standard deviation of x */
  deviation_x: number;
  /** m, standard deviation of y */
  deviation_y: number;
}

export interface Rows {
  imu: ImuRow;
  depth: DepthRow;
  beacon: BeaconRow;
  motor: MotorRow;
  status: StatusRow;
  navigation: NavigationRow;
  control: ControlRow;
  link: LinkRow;
  truth: TruthRow;
  turning: TurningRow;
  track: TrackRow;
}

export const DOCUMENT_TOPICS = {
  state: 16,
  detection: 17,
  debug: 18,
  event: 19,
  notice: 20,
  parameters: 21,
  experiment: 22,
  vision: 23,
  calibration: 24,
  mission: 25,
  craft: 26,
} as const;

export const PICTURE_TOPICS = {
  picture: 32,
  observer: 33,
  thumbnail: 34,
  mask: 35,
  balanced: 36,
  camera: 37,
  snapshot: 38,
} as const;

/** A fault that is active, or not acknowledged yet. */
export interface Alarm {
  fault: string;
  severity: 'info' | 'caution' | 'alarm';
  since: number;
  until: number | null;
  active: boolean;
  acknowledged: boolean;
  what: string;
  cause: string;
  remedy: string;
  consequences: string[];
}

/** The period, s, at which the board sends a topic at this baud rate. */
export interface Pace {
  topic: string;
  period: number;
}

/** One number of a controller that may be tuned. */
export interface Gain {
  name: string;
  value: number;
  minimum: number;
  maximum: number;
  unit: string;
  meaning: string;
}

/** A controller that can be chosen, and its gains as they stand. */
export interface ControllerChoice {
  name: string;
  title: string;
  gains: Gain[];
}

/** A control loop: depth (m), heading, pitch or roll (rad). */
export interface Loop {
  name: string;
  on: boolean;
  set_point: number;
  controller: string;
  controllers: ControllerChoice[];
}

/** The robot as a whole; sent once a second and at every change. */
export interface State {
  time: number;
  run: string;
  mode: 'disarmed' | 'manual' | 'automatic' | 'test' | 'failsafe';
  armed: boolean;
  armed_since: number | null;
  alarms: Alarm[];
  refusals: string[];
  connected: boolean;
  connection: string;
  port: string;
  baud: number;
  paces: Pace[];
  epoch: number | null;
  set_point_default: number;
  set_point_detected: number;
  unwatched: number;
  deepest: number;
  battery_left: number | null;
  buoyancy_known: boolean;
  steering: 'none' | 'beacons';
  control_rate: number;
  profile: 'full' | 'lean';
  vision_rate: number;
  vision_colour: string;
  colours: string[];
  card: string | null;
  cards: string[];
  camera: string;
  stream_rate: number;
  loops: Loop[];
  pilot_dropped: number;
}

/** A rectangle in the picture; each number a share of the picture's width or height. */
export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** A patch of the target colour, with its measures; `refused` says why it does not count. */
export interface Candidate {
  box: Box;
  area: number;
  fill: number;
  aspect: number;
  circularity: number;
  refused: string;
}

/** An ArUco marker in the picture. */
export interface ArucoMarker {
  number: number;
  corners: number[];
}

/** The result of searching one picture: the largest patch of the colour that was found. */
export interface Detection {
  time: number;
  taken: number;
  colour: string | null;
  box: Box | null;
  area: number;
  processing: number;
  candidates: Candidate[];
  markers: ArucoMarker[];
  confirmed: string[];
  target: string | null;
  set_point: number | null;
  latency: number | null;
}

/** An event of the board in words, or a line of text of its sketch; level as in DebugLevel. */
export interface DebugLine {
  time: number;
  level: number;
  text: string;
}

/** Something that happened, in words for a person; `kind` is one word for programs. */
export interface RobotEvent {
  time: number;
  kind: string;
  severity: 'info' | 'caution' | 'alarm';
  text: string;
}

/** Something that may be tuned while the robot runs, and its value. */
export interface TunableParameter {
  name: string;
  type: 'number' | 'whole' | 'choice' | 'switch';
  value: number | string | boolean;
  default: number | string | boolean;
  minimum: number | null;
  maximum: number | null;
  unit: string;
  meaning: string;
  choices: string[];
  where: 'runtime' | 'firmware';
  while_armed: boolean;
  pending: boolean;
}

/** Every parameter; sent at each change and every ten seconds. */
export interface Parameters {
  time: number;
  parameters: TunableParameter[];
}

/** The progress of an experiment on a loop; sent at every change, twice a second, and once at its end. */
export interface Experiment {
  time: number;
  number: number;
  kind: 'step' | 'relay';
  loop: string;
  phase: 'settling' | 'balancing' | 'running' | 'complete' | 'stopped' | 'failed';
  since: number;
  progress: number;
  cycles: number;
  bias: number;
  text: string;
}

/** The range of one colour: lowest and highest hue, saturation and value, both included.

    A hue range whose first number is above its second runs through 0, where red lies. Raises ValueError
    where another one does.
     */
export interface ColourRange {
  hue: [number, number];
  saturation: [number, number];
  value: [number, number];
}

/** Rate in Hz; areas as shares of the picture, `opening` as a share of its width.

    `colour` is the target colour, whose mask is shown. A patch counts if its area, its fill (area over that
    of its upright box), its aspect (the box's width over height) and its circularity (4π·area over
    perimeter²; 1: a circle) lie within these limits. Without `marker_numbers` every marker of the dictionary
    counts. `actions` are set points (m) while a colour or `marker 7` is seen. With `confirmation` (2, 3) it
    is seen while at least 2 of the last 3 pictures show it. The picture is turned clockwise by `turn` °,
    then mirrored left to right. `exposure` (ms), `gain` and `colour_temperature` (K) fix what a Pi or USB
    camera else chooses by itself; 0 leaves it to the camera. Raises ConfigError on settings that contradict
    each other.
     */
export interface VisionSettings {
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
  turn: 0 | 90 | 180 | 270;
  mirror: boolean;
  exposure: number;
  gain: number;
  colour_temperature: number;
}

/** The vision settings in force; sent at every change and every ten seconds. */
export interface VisionInForce {
  time: number;
  settings: VisionSettings;
}

/** A robot's calibration as its board keeps it. Fins: front right, back right, back left, front left. */
export interface CalibrationValues {
  done: ('fins' | 'motors' | 'axes' | 'gyro' | 'pressure' | 'battery' | 'beacons')[];
  fin_zeros: [number, number, number, number];
  encoders_reversed: [boolean, boolean, boolean, boolean];
  motors_reversed: [boolean, boolean, boolean, boolean];
  axes: ['x' | '-x' | 'y' | '-y' | 'z' | '-z', 'x' | '-x' | 'y' | '-y' | 'z' | '-z', 'x' | '-x' | 'y' | '-y' | 'z' | '-z'];
  gyro_bias: [number, number, number];
  pressure_offset: number;
  battery_factor: number;
  beacons_inverted: boolean;
}

/** The calibration that the board stores; sent at every change and every ten seconds. */
export interface CalibrationKept {
  time: number;
  values: CalibrationValues | null;
  missing: string[];
}

/** A step of a running mission. */
export interface MissionStepState {
  path: string;
  do: string;
  words: string;
  note: string;
  status: 'waiting' | 'running' | 'done' | 'failed' | 'stopped';
  elapsed: number;
  longest: number;
  rounds: number;
  text: string;
}

/** A mission as it stands: sent at its start, at each change, once a second, and at its end.

    Each states everything but `document`, which only the first and the last one have.
     */
export interface Mission {
  time: number;
  number: number;
  sequence: number;
  name: string;
  title: string;
  phase: 'running' | 'paused' | 'succeeded' | 'failed' | 'ended';
  text: string;
  elapsed: number;
  remaining: number;
  progress: number;
  paused: number;
  pause: number;
  deepest: number;
  steps: MissionStepState[];
  document: string;
  surfaced: number | null;
}

/** The error model of a sensor, in the units of its reading. Raises ValueError below 0. */
export interface SensorQuality {
  rate: number;
  latency: number;
  noise: number;
  bias: number;
  walk: number;
  step: number;
}

/** The numbers of one robot; the defaults are those of µ-CAT. Raises ValueError for a mass of 0. */
export interface Craft {
  mass: number;
  size: [number, number, number];
  inertia: [number, number, number];
  buoyancy: number;
  buoyancy_forward: number;
  buoyancy_right: number;
  buoyancy_height: number;
  restitution: number;
  friction: number;
  added_mass: [number, number, number, number, number, number];
  damping_linear: [number, number, number, number, number, number];
  damping_quadratic: [number, number, number, number, number, number];
  fin_positions: [[number, number], [number, number], [number, number], [number, number]];
  fin_mount: number;
  fin_area: number;
  fin_centre: number;
  fin_drag: number;
  fin_thrust_per_drag: number;
  fin_normal: number;
  fin_delay: number;
  pressure_position: [number, number, number];
  gyroscope_offset: [number, number, number];
  accelerometer_offset: [number, number, number];
  pressure: SensorQuality;
  gyroscope: SensorQuality;
  accelerometer: SensorQuality;
  encoder: SensorQuality;
}

/** The craft that the simulator swims; sent at its start, at every change and every ten seconds. */
export interface SwimmingCraft {
  time: number;
  title: string;
  origin: string;
  craft: Craft;
}

export interface Documents {
  state: State;
  detection: Detection;
  debug: DebugLine;
  event: RobotEvent;
  notice: RobotEvent;
  parameters: Parameters;
  experiment: Experiment;
  vision: VisionInForce;
  calibration: CalibrationKept;
  mission: Mission;
  craft: SwimmingCraft;
}
