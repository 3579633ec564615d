// Written by `make generate` from robot_runtime/contract/packets/definitions.py. Do not edit.
#pragma once
#include <stdint.h>

#include "board/flash.h"

namespace mucat {

constexpr uint32_t kDefinitionsHash = 0x718dde94UL;
constexpr uint8_t kFinCount = 4;
constexpr uint8_t kFrameBytesMax = 64;
constexpr uint8_t kNotReady = 128;
// Version of the calibration's record in EEPROM; it changes with the record's layout.
constexpr uint8_t kCalibrationVersion = 155;

enum class DebugLevel : uint8_t {
  kDebug = 0,
  kInfo = 1,
  kWarning = 2,
  kError = 3,
};

enum class StatusFlag : uint8_t {
  kArmed = 1,
  kHostAlive = 2,
  kNeutral = 4,
  kMotorPower = 8,
  kBatteryLow = 16,
  kDefinitionsDiffer = 32,
  kHil = 64,
};

enum class DeviceFault : uint32_t {
  kImu = 1,
  kPressure = 2,
  kEncoderFrontRight = 4,
  kEncoderBackRight = 8,
  kEncoderBackLeft = 16,
  kEncoderFrontLeft = 32,
  kBridgeFrontRight = 64,
  kBridgeBackRight = 128,
  kBridgeBackLeft = 256,
  kBridgeFrontLeft = 512,
  kTrackingFrontRight = 1024,
  kTrackingBackRight = 2048,
  kTrackingBackLeft = 4096,
  kTrackingFrontLeft = 8192,
  kMagnet = 16384,
  kSurface = 32768,
  kLeak = 65536,
};

enum class ResetCause : uint8_t {
  kUnknown = 0,
  kPowerOn = 1,
  kExternal = 2,
  kBrownOut = 3,
  kWatchdog = 4,
};

enum class CalibrationStep : uint8_t {
  kFins = 1,
  kMotors = 2,
  kAxes = 4,
  kGyro = 8,
  kPressure = 16,
  kBattery = 32,
  kBeacons = 64,
};

enum class BoardEventKind : uint8_t {
  kBoot = 0,
  kArmed = 1,
  kRefused = 2,
  kDisarmed = 3,
  kBattery = 4,
  kFault = 5,
  kFaultOver = 6,
};

enum class Refusal : uint8_t {
  kNone = 0,
  kNoHello = 1,
  kDefinitions = 2,
  kEpoch = 3,
  kTraffic = 4,
  kBattery = 5,
  kCalibration = 6,
  kSurface = 7,
  kLeak = 8,
};

enum class Disarming : uint8_t {
  kNone = 0,
  kStop = 1,
  kSilence = 2,
  kBattery = 3,
  kDefinitions = 4,
  kHost = 5,
  kLeak = 6,
};

// Host to board: disarm at once. Always accepted, also outside a session and repeatedly.
struct __attribute__((packed)) Stop {
  static constexpr uint8_t kType = 0x00;
};
static_assert(sizeof(Stop) == 1, "Stop has another size");

// Host to board: arm. Refused unless the epoch is this boot's and valid traffic came for 500 ms.
struct __attribute__((packed)) Start {
  static constexpr uint8_t kType = 0x01;
  uint16_t epoch;  // epoch of the addressed boot, from the board's Hello; 0: none
};
static_assert(sizeof(Start) == 2, "Start has another size");

// Host to board: the commanded force and torque, each as a share of the maximum. Expires after 250 ms.
struct __attribute__((packed)) Navigation {
  static constexpr uint8_t kType = 0x02;
  int8_t x;  // forwards; x 0.00787401575
  int8_t y;  // to the right; x 0.00787401575
  int8_t z;  // downwards; x 0.00787401575
  int8_t roll;  // right side down; x 0.00787401575
  int8_t pitch;  // nose up; x 0.00787401575
  int8_t yaw;  // to the right; x 0.00787401575
};
static_assert(sizeof(Navigation) == 6, "Navigation has another size");

// Board to host, 100 Hz: attitude, turn rate and specific force, body axes forward, right, down.
struct __attribute__((packed)) Imu {
  static constexpr uint8_t kType = 0x03;
  uint32_t time;  // the board's own clock, which wraps after 71 minutes; µs
  int16_t attitude[4];  // unit quaternion w, x, y, z that turns body into world; x 6.10351562e-05
  int16_t rate[3];  // turn rate (65.5 counts per °/s); x 0.00026632423 rad/s
  int16_t force[3];  // specific force (8192 counts per g); x 0.0011971008 m/s²
};
static_assert(sizeof(Imu) == 24, "Imu has another size");

// Board to host, 50 Hz: depth below the surface, from pressure.
struct __attribute__((packed)) Depth {
  static constexpr uint8_t kType = 0x04;
  uint32_t time;  // the board's own clock, which wraps after 71 minutes; µs
  int16_t depth;  // depth below the surface, downwards; x 0.001 m
  uint32_t pressure;  // absolute pressure; Pa
  int16_t temperature;  // temperature of the water; x 0.01 °C
};
static_assert(sizeof(Depth) == 12, "Depth has another size");

// Board to host, 10 Hz: the light-beacon detectors.
struct __attribute__((packed)) Beacon {
  static constexpr uint8_t kType = 0x05;
  uint32_t time;  // the board's own clock, which wraps after 71 minutes; µs
  uint8_t right;  // 1 while the right detector sees the beacon
  uint8_t left;  // 1 while the left detector sees the beacon
};
static_assert(sizeof(Beacon) == 6, "Beacon has another size");

// Board to host, 50 Hz: commanded and measured angles of the four fins, and the H-bridge commands.
struct __attribute__((packed)) Motor {
  static constexpr uint8_t kType = 0x06;
  uint32_t time;  // the board's own clock, which wraps after 71 minutes; µs
  int16_t wanted[4];  // commanded fin angle; x 0.001 rad
  int16_t angle[4];  // measured fin angle; x 0.001 rad
  int8_t drive[4];  // H-bridge command, -63 to 63
};
static_assert(sizeof(Motor) == 24, "Motor has another size");

// Board to host: a line of text, from a sketch of one's own.
struct __attribute__((packed)) Debug {
  static constexpr uint8_t kType = 0x09;
  uint32_t time;  // the board's own clock, which wraps after 71 minutes; µs
  uint8_t level;  // see DebugLevel
  uint8_t text_size;
  char text[40];
  static constexpr uint8_t kTextMax = 40;
};
static_assert(sizeof(Debug) == 46, "Debug has another size");

// Both ways: identifies the sender. The board answers each Hello, and sends one at its start.
struct __attribute__((packed)) Hello {
  static constexpr uint8_t kType = 0x0a;
  uint32_t definitions;  // hash of the packet definitions
  uint16_t epoch;  // epoch of the board's boot or of the host's run
  uint16_t credit;  // bytes that the sender can receive at once; B
};
static_assert(sizeof(Hello) == 8, "Hello has another size");

// Board to host, 10 Hz: the board's state and health.
struct __attribute__((packed)) Status {
  static constexpr uint8_t kType = 0x0b;
  uint32_t time;  // the board's own clock, which wraps after 71 minutes; µs
  uint16_t epoch;  // epoch of the board's boot
  uint8_t flags;  // see StatusFlag
  uint32_t faults;  // see DeviceFault
  uint8_t reset_cause;  // see ResetCause
  uint16_t battery;  // battery voltage; x 0.001 V
  uint16_t loop_worst;  // longest pass of the main loop since the last status; µs
  uint16_t missed_ticks;  // passes of the main loop missed since the start
  uint16_t frames_invalid;  // invalid frames dropped since the start
  uint16_t bytes_lost;  // received bytes lost to a full buffer since the start
  uint16_t debug_lost;  // events and lines lost to a full buffer since the start
  uint16_t stack_free;  // memory that the stack has never used; B
};
static_assert(sizeof(Status) == 26, "Status has another size");

// Host to board, 10 Hz: the host is alive.
struct __attribute__((packed)) Heartbeat {
  static constexpr uint8_t kType = 0x0c;
  uint32_t time;  // the host's clock, for logs only; ms
};
static_assert(sizeof(Heartbeat) == 4, "Heartbeat has another size");

// Both ways: the reliable frames received after the first missing one.
struct __attribute__((packed)) Acknowledge {
  static constexpr uint8_t kType = 0x0d;
  uint8_t held;  // bit n: frame acknowledged + 1 + n was received; bit 7: no room
};
static_assert(sizeof(Acknowledge) == 1, "Acknowledge has another size");

// Both ways, only in the communication test: a number.
struct __attribute__((packed)) TestMsg {
  static constexpr uint8_t kType = 0x0e;
  uint16_t number;
};
static_assert(sizeof(TestMsg) == 2, "TestMsg has another size");

// Host to board, only in the communication test: asks for the result.
struct __attribute__((packed)) RequestResult {
  static constexpr uint8_t kType = 0x0f;
};
static_assert(sizeof(RequestResult) == 1, "RequestResult has another size");

// Board to host, only in the communication test: counts of received numbers and frames.
struct __attribute__((packed)) TestResult {
  static constexpr uint8_t kType = 0x10;
  uint16_t right;  // numbers of the test in ascending order
  uint16_t out_of_sequence;  // other numbers
  uint16_t frames_invalid;  // invalid frames dropped
  uint16_t frames_repeated;  // reliable frames sent again
  uint16_t bytes_lost;  // received bytes lost to a full buffer
};
static_assert(sizeof(TestResult) == 10, "TestResult has another size");

// Host to board, only with hardware in the loop: simulated sensor readings; the newest counts.
struct __attribute__((packed)) Sense {
  static constexpr uint8_t kType = 0x11;
  uint32_t pressure;  // absolute pressure; Pa
  int16_t temperature;  // temperature of the water; x 0.01 °C
  int16_t rate[3];  // turn rate (65.5 counts per °/s); x 0.00026632423 rad/s
  int16_t force[3];  // specific force (8192 counts per g); x 0.0011971008 m/s²
  uint8_t right;  // 1 while the right detector sees the beacon
  uint8_t left;  // 1 while the left detector sees the beacon
  uint16_t battery;  // battery voltage; x 0.001 V
};
static_assert(sizeof(Sense) == 22, "Sense has another size");

// Host to board: a new value of a parameter. Board to host, in answer: the value in force.
struct __attribute__((packed)) Parameter {
  static constexpr uint8_t kType = 0x12;
  uint8_t number;  // index in CHIP_PARAMETERS
  uint16_t value;  // in the parameter's own unit; x 0.001
};
static_assert(sizeof(Parameter) == 3, "Parameter has another size");

// Host to board: the calibration to keep. Board to host, in answer: the one that it keeps in EEPROM.
//
// A board arms only when every step is done. While it is armed it keeps what it has.
struct __attribute__((packed)) Calibration {
  static constexpr uint8_t kType = 0x13;
  uint8_t done;  // see CalibrationStep
  uint16_t fin_zeros[4];  // encoder counts, 1024 a turn, where the fin points along its mount
  uint8_t encoders_reversed;  // bit n: fin n's counts fall as its tip goes down
  uint8_t motors_reversed;  // bit n: fin n's counts fall at positive drive
  int8_t axes[3];  // the chip's axes, 1 to 3, that point forward, right, down; -: away
  int16_t gyro_bias[3];  // turn rate measured at rest, body axes; x 0.00026632423 rad/s
  int16_t pressure_offset;  // what the sensor shows too much; Pa
  uint16_t battery_factor;  // true battery voltage over measured; x 0.0001
  uint8_t beacons_inverted;  // 1: a detector's pin is low while it sees the beacon
};
static_assert(sizeof(Calibration) == 25, "Calibration has another size");

// Host to board: asks for the calibration that it keeps.
struct __attribute__((packed)) RequestCalibration {
  static constexpr uint8_t kType = 0x14;
};
static_assert(sizeof(RequestCalibration) == 1, "RequestCalibration has another size");

// Host to board: the pressure now is the surface's. Ignored while armed.
struct __attribute__((packed)) ZeroDepth {
  static constexpr uint8_t kType = 0x15;
};
static_assert(sizeof(ZeroDepth) == 1, "ZeroDepth has another size");

// Host to board, only in the bring-up: asks which devices answer on I2C, with power on the motors.
struct __attribute__((packed)) RequestScan {
  static constexpr uint8_t kType = 0x16;
};
static_assert(sizeof(RequestScan) == 1, "RequestScan has another size");

// Board to host, only in the bring-up: the addresses that answered.
struct __attribute__((packed)) Scan {
  static constexpr uint8_t kType = 0x17;
  uint8_t answered[16];  // bit a % 8 of byte a / 8: address a
};
static_assert(sizeof(Scan) == 16, "Scan has another size");

// Host to board, only in the bring-up: drives one motor, for 250 ms.
struct __attribute__((packed)) Jog {
  static constexpr uint8_t kType = 0x18;
  uint8_t fin;  // 0 to 3, by the H-bridge's address
  int8_t drive;  // H-bridge command, -20 to 20
};
static_assert(sizeof(Jog) == 2, "Jog has another size");

// Board to host, only in the bring-up, 20 Hz: the devices' raw readings.
struct __attribute__((packed)) Raw {
  static constexpr uint8_t kType = 0x19;
  uint32_t time;  // the board's own clock, which wraps after 71 minutes; µs
  uint16_t encoders[4];  // the AS5040's words: 10 bits, then status
  uint8_t identity;  // the IMU's WHO_AM_I; 0 where nothing answers
  int16_t rate[3];  // turn rate about the chip's axes; x 0.00026632423 rad/s
  int16_t force[3];  // specific force along the chip's axes; x 0.0011971008 m/s²
  uint32_t pressure;  // absolute pressure; 0 where nothing answers; Pa
  int16_t temperature;  // temperature of the water; x 0.01 °C
  uint16_t battery;  // the converter's counts, 1023 for twice 5 V
  uint8_t beacons;  // levels of the detectors' pins; bit 0: right, bit 1: left
  uint8_t leak;  // 1 while the leak sensor is wet
};
static_assert(sizeof(Raw) == 35, "Raw has another size");

// Board to host: an event, which the host puts into words (`robot_runtime/contract/board_events.py`).
struct __attribute__((packed)) BoardEvent {
  static constexpr uint8_t kType = 0x1a;
  uint32_t time;  // the board's own clock, which wraps after 71 minutes; µs
  uint8_t kind;  // see BoardEventKind
  uint8_t detail;  // as the kind says
  uint16_t value;  // as the kind says
};
static_assert(sizeof(BoardEvent) == 8, "BoardEvent has another size");

// Host to board: the LED of an armed robot counts down. Expires after 300 ms.
struct __attribute__((packed)) Countdown {
  static constexpr uint8_t kType = 0x1b;
  uint8_t remaining;  // time until the end of the countdown; x 0.1 s
};
static_assert(sizeof(Countdown) == 1, "Countdown has another size");

// Payload bytes by type, in flash: the compiler puts the table of a switch into RAM.
const int8_t kPayloadBytes[] PROGMEM = {0, 2, 6, 24, 12, 6, 24, -1, -1, -1, 8, 26, 4, 1, 2, 0, 10, 22, 3, 25, 0, 0, 0, 16, 2, 35, 8, 1};

// Payload bytes of a type of fixed length; -1 for an unknown one or one that carries text.
inline int8_t payload_bytes(uint8_t type) {
  if (type >= sizeof kPayloadBytes) return -1;
  return static_cast<int8_t>(pgm_read_byte(&kPayloadBytes[type]));
}

// Whether a packet of this type is repeated until it is acknowledged.
constexpr bool is_reliable(uint8_t type) { return type == Start::kType || type == Debug::kType || type == TestMsg::kType || type == RequestResult::kType || type == TestResult::kType || type == Parameter::kType || type == Calibration::kType || type == RequestCalibration::kType || type == ZeroDepth::kType || type == RequestScan::kType || type == Scan::kType || type == BoardEvent::kType; }

}  // namespace mucat
