// The firmware's parts with plain C names, for tests in Python.
#include <string.h>

#include "board.h"
#include "calibration.h"
#include "fins/fin_law.h"
#include "fins/mixer.h"
#include "fins/position_loop.h"
#include "link/cobs.h"
#include "link/crc32.h"
#include "link/debug.h"
#include "link/frame.h"
#include "link/message_queue.h"
#include "robot.h"
#include "sensors/as5040.h"
#include "sensors/attitude.h"
#include "sensors/battery.h"
#include "sensors/ms5837.h"

using namespace mucat;

namespace {

// The emulated board's.
Calibration calibrated() {
  CalibrationStore store;
  store.start();
  return store.value();
}

Parameters initial() {
  Parameters parameters;
  parameters.start();
  return parameters;
}

}  // namespace

extern "C" {

// ---- link ----

uint32_t firmware_crc32(const uint8_t* bytes, uint8_t size) { return crc32(bytes, size); }

uint8_t firmware_encode_cobs(const uint8_t* bytes, uint8_t size, uint8_t* out) {
  return encode_cobs(bytes, size, out);
}

uint8_t firmware_decode_cobs(uint8_t* bytes, uint8_t size) { return decode_cobs(bytes, size); }

FrameDecoder* decoder_create() { return new FrameDecoder; }
void decoder_destroy(FrameDecoder* decoder) { delete decoder; }
bool decoder_feed(FrameDecoder* decoder, uint8_t byte) { return decoder->feed(byte); }
uint8_t decoder_number(const FrameDecoder* decoder) { return decoder->number(); }
void decoder_set_key(FrameDecoder* decoder, uint32_t key) { decoder->set_key(key); }
bool decoder_open(const FrameDecoder* decoder) { return decoder->open(); }
uint16_t decoder_invalid(const FrameDecoder* decoder) { return decoder->invalid(); }

// Writes the next message's type and payload; returns the payload's size, or -1 after the last message.
int decoder_next(FrameDecoder* decoder, uint8_t* type, uint8_t* out) {
  Message message;
  if (!decoder->next(&message)) return -1;
  *type = message.type;
  memcpy(out, message.payload, message.size);
  return message.size;
}

FramePacker* packer_create() { return new FramePacker; }
void packer_destroy(FramePacker* packer) { delete packer; }

bool packer_add(FramePacker* packer, uint8_t type, const uint8_t* payload, uint8_t size) {
  if (!packer->fits(size)) return false;
  packer->add(type, payload, size);
  return true;
}

// `frame` holds kFrameBytesMax bytes.
uint8_t packer_close(FramePacker* packer, uint16_t number, uint8_t acknowledged, uint32_t key,
                     uint8_t* frame) {
  return packer->close(number, acknowledged, key, *reinterpret_cast<uint8_t(*)[kFrameBytesMax]>(frame));
}

MessageQueue* queue_create() { return new MessageQueue; }
void queue_destroy(MessageQueue* queue) { delete queue; }

bool queue_push(MessageQueue* queue, uint8_t type, const uint8_t* payload, uint8_t size) {
  return queue->push(type, payload, size);
}

// Removes the oldest message, its type first; returns its size, or 0 if there is none.
uint8_t queue_pop(MessageQueue* queue, uint8_t* out) {
  uint8_t message[kReliableBytesMax];
  const uint8_t size = queue->peek(0, message);
  queue->drop(size);
  memcpy(out, message, size);
  return size;
}

// Writes a number like a debug line, with that many digits, or with as many as needed if `digits` is 0.
uint8_t debug_number(uint16_t number, uint8_t digits, char* text) {
  DebugLine line(DebugLevel::kInfo);
  if (digits) {
    line.digits(number, digits);
  } else {
    line << number;
  }
  memcpy(text, line.packet().text, line.packet().text_size);
  return line.packet().text_size;
}

// ---- fins ----

// `command` is x, y, z, roll, pitch, yaw; `directions` are input and output.
void firmware_mix(const int8_t* command, float* directions, float* amplitudes) {
  Navigation navigation;
  memcpy(&navigation, command, sizeof navigation);
  FinDemand demands[kFinCount];
  for (uint8_t i = 0; i < kFinCount; ++i) demands[i] = {directions[i], 0};
  mix(navigation, initial().value(kFinsAmplitude), demands);
  for (uint8_t i = 0; i < kFinCount; ++i) {
    directions[i] = demands[i].direction;
    amplitudes[i] = demands[i].amplitude;
  }
}

FinLaw* law_create(float angle) {
  FinLaw* const law = new FinLaw;
  law->start(angle);
  return law;
}
void law_destroy(FinLaw* law) { delete law; }
float law_step(FinLaw* law, float direction, float amplitude, uint16_t phase) {
  return law->step({direction, amplitude}, phase, initial().value(kFinsTurnRate) * kTickSeconds);
}
bool law_flapping(const FinLaw* law) { return law->flapping(); }
uint16_t law_phase_per_tick() { return phase_per_tick(initial().value(kFinsFrequency)); }
uint16_t law_fin_phase(uint8_t fin) { return fin_phase(fin); }

int16_t firmware_wrap_counts(int16_t counts) { return wrap_counts(counts); }
int16_t firmware_counts_from_angle(uint8_t fin, float angle) {
  return counts_from_angle(fin_calibration(calibrated(), fin), angle);
}
float firmware_angle_from_counts(uint8_t fin, int16_t counts) {
  return angle_from_counts(fin_calibration(calibrated(), fin), counts);
}
PositionLoop* loop_create() { return new PositionLoop; }
void loop_destroy(PositionLoop* loop) { delete loop; }
int8_t loop_step(PositionLoop* loop, uint8_t fin, int16_t set_point, int16_t measured) {
  return loop->step(fin_calibration(calibrated(), fin), set_point, measured,
                    gain_from_thousandths(initial()[kFinsGain]));
}

// ---- sensors ----

// Fin 0's encoder counts for this word; -1 if the word is refused.
int firmware_encoder_counts(uint16_t word) {
  host::the_board.encoders[0] = word;
  int16_t counts;
  return read_encoder_counts(0, &counts) == MagneticField::kUnusable ? -1 : counts;
}

bool firmware_prom_valid(const uint16_t* prom) {
  return prom_valid(*reinterpret_cast<const uint16_t(*)[kPromWords]>(prom));
}

void firmware_compensate(const uint16_t* prom, uint32_t d1, uint32_t d2, int32_t* pressure,
                         int16_t* temperature) {
  const PressureReading reading = compensate(*reinterpret_cast<const uint16_t(*)[kPromWords]>(prom), d1, d2);
  *pressure = reading.pressure;
  *temperature = reading.temperature;
}

Attitude* attitude_create() {
  Attitude* const attitude = new Attitude;
  attitude->start();
  return attitude;
}
void attitude_destroy(Attitude* attitude) { delete attitude; }
void attitude_update(Attitude* attitude, const float* rate, const float* force, float seconds,
                     float* quaternion) {
  attitude->update(*reinterpret_cast<const float(*)[3]>(rate), *reinterpret_cast<const float(*)[3]>(force),
                   seconds);
  memcpy(quaternion, attitude->quaternion(), 4 * sizeof(float));
}

uint16_t firmware_battery_millivolts(uint16_t counts, uint16_t factor) {
  return battery_millivolts(counts, factor);
}

// ---- the whole robot on the board in memory ----

void board_set_i2c(host::I2cBus bus) { host::the_board.i2c = bus; }
void board_set_encoder(uint8_t fin, uint16_t word) { host::the_board.encoders[fin] = word; }
void board_set_battery(uint16_t counts) { host::the_board.battery = counts; }
void board_set_beacons(bool right, bool left) {
  host::the_board.right = right;
  host::the_board.left = left;
}
void board_set_leak(bool leak) { host::the_board.leak = leak; }
// The EEPROM as the factory delivers it.
void board_erase_eeprom() { memset(host::the_board.eeprom, 0xFF, sizeof host::the_board.eeprom); }
void board_flip_eeprom(uint8_t index) { host::the_board.eeprom[index] ^= 0x10; }
uint16_t board_epoch() { return host::the_board.epoch; }
bool board_led() { return host::the_board.led; }
bool board_motor_power() { return host::the_board.motor_power; }
void board_advance(uint32_t us) { host::advance(us); }
uint64_t board_now_us() { return host::the_board.now_us; }
uint64_t board_fed_us() { return host::the_board.fed_us; }
uint32_t board_overwritten() { return host::the_board.overwritten; }

void board_receive(const uint8_t* bytes, uint32_t size) {
  host::the_board.to_board.insert(host::the_board.to_board.end(), bytes, bytes + size);
}

// Reads up to `room` bytes that the board sent; returns their count.
uint32_t board_take(uint8_t* bytes, uint32_t room) {
  std::vector<uint8_t>& sent = host::the_board.to_host;
  const uint32_t size = sent.size() < room ? sent.size() : room;
  memcpy(bytes, sent.data(), size);
  sent.erase(sent.begin(), sent.begin() + size);
  return size;
}

// Creates a new board without any memory.
void board_power_up() { host::the_board = host::Board(); }

Robot* robot_start(uint8_t reset_cause) {
  host::reset(static_cast<ResetCause>(reset_cause));
  Robot* const robot = new Robot;
  robot->start();
  return robot;
}
void robot_destroy(Robot* robot) { delete robot; }

// Runs the main loop for this time, one pass a millisecond.
void robot_run(Robot* robot, uint32_t milliseconds) {
  while (milliseconds--) {
    host::advance(1000);
    robot->step();
  }
}
}
