#include "robot.h"

#include "board/board.h"
#include "schedule.h"
#include "sensors/simulated_input.h"

namespace mucat {
namespace {

constexpr uint8_t kTicksPerSecond = 100;
constexpr uint16_t kNoBoot = 0;
// Time for the fins to turn down once the battery is low; half a turn takes 0.64 s.
constexpr uint32_t kLoweringMs = 1500;

template <typename Enum>
constexpr uint8_t bit(Enum flag, bool on) {
  return on ? static_cast<uint8_t>(flag) : 0;
}

}  // namespace

void Robot::start() {
  board::start();
  calibration_.start();
  parameters_.start();
  fins_.start(calibration_.value());
  epoch_ = board::next_epoch();
  arming_.begin(epoch_);
  sensors_.start(calibration_.value());
  report_boot();
  link_.greet(epoch_);
}

void Robot::step() {
  const uint32_t started = board::microseconds();
  if (link_.receive()) {
    arming_.note_reception(board::milliseconds());
    for (Message message; link_.next(&message);) handle(message);
  }
  const uint8_t ticks = board::take_ticks();
  if (ticks == 0) {
    board::rest();
    return;
  }
  missed_ticks_ += ticks - 1;
  tick(ticks);
  board::feed_watchdog();
  const uint32_t took = board::microseconds() - started;
  if (took > loop_worst_) loop_worst_ = took > UINT16_MAX ? UINT16_MAX : took;
}

void Robot::handle(const Message& message) {
  switch (message.type) {
    case Stop::kType:
      report_disarmed(arming_.stop());
      lowering_ = false;
      // At once, not at the next tick.
      fins_.step(Motion::kOff, parameters_);
      break;
    case Hello::kType:
      greet(unpack<Hello>(message));
      break;
    case Start::kType:
      arm(unpack<Start>(message));
      break;
    case Navigation::kType:
      if (arming_.navigate(board::milliseconds())) fins_.command(unpack<Navigation>(message));
      break;
    case Countdown::kType:
      led_.count_down(unpack<Countdown>(message).remaining);
      break;
    case Sense::kType:
      accept_simulated_input(unpack<Sense>(message));
      break;
    case Parameter::kType:
      // With other definitions, or unknown ones, its number may mean another parameter.
      if (arming_.agreed()) parameters_.request(unpack<Parameter>(message), armed());
      break;
    default:
      handle_calibration(message);
  }
}

// A heartbeat needs no handling; the other types are the board's, or for other sketches.
void Robot::handle_calibration(const Message& message) {
  if (message.type == RequestCalibration::kType) calibration_.request();
  if (message.type == ZeroDepth::kType && !armed()) sensors_.zero_depth();
  // With other definitions, or unknown ones, its bytes may mean something else.
  if (message.type != Calibration::kType || !arming_.agreed()) return;
  if (armed()) {
    calibration_.request();
  } else {
    calibration_.store(unpack<Calibration>(message));
  }
}

void Robot::greet(const Hello& hello) {
  report_disarmed(arming_.greet(hello));
  link_.answer(hello, epoch_);
}

void Robot::arm(const Start& start) {
  // The host voided it while it was in transit.
  if (start.epoch == kNoBoot) return;
  const bool was_armed = armed();
  const uint8_t missing = calibration_.missing();
  const Refusal refusal =
      arming_.start(start, !missing, !sensors_.surface_uncertain(), board::milliseconds());
  if (refusal != Refusal::kNone) {
    const uint8_t steps = refusal == Refusal::kCalibration ? missing : 0;
    link_.queue_event(BoardEventKind::kRefused, static_cast<uint8_t>(refusal), steps);
  } else if (!was_armed) {
    link_.queue_event(BoardEventKind::kArmed);
  }
}

void Robot::tick(uint8_t ticks) {
  const uint32_t now = board::milliseconds();
  report_disarmed(arming_.tick(now));
  watch_battery(now);
  watch_leak();
  // First, so that a command takes effect with the least delay.
  fins_.step(motion(now), parameters_);
  sensors_.step(ticks, armed());
  calibration_.step();
  board::set_led(led_.lit(armed(), faults() || battery_alarm_.on(), tick_of_second_));
  tick_of_second_ = (tick_of_second_ + 1) % kTicksPerSecond;
  if (slot_tick_ < kTicksPerSlot) ++slot_tick_;
  // On a slow line telemetry waits until it can be sent, so that it is new.
  if (slot_tick_ == kTicksPerSlot && (kTicksPerSlot == 1 || link_.line_idle())) {
    slot_tick_ = 0;
    send_telemetry();
    slot_ = (slot_ + 1) % kSlots;
  }
  // Before a host's HELLO only telemetry is sent, in open frames, which show a host whose HELLO was lost that
  // this board has restarted. Reliable messages, such as those of the boot, wait in the queue.
  if (!arming_.greeted()) return;
  answer_requests();
  link_.step(now);
}

// Answers that do not fit the queue are sent in a later tick.
void Robot::answer_requests() {
  for (Parameter answer; parameters_.next(&answer) && link_.queue(answer);) {
    parameters_.answered(answer.number);
  }
  if (calibration_.answer_due() && link_.queue(calibration_.value())) calibration_.answered();
}

void Robot::watch_battery(uint32_t now_ms) {
  const uint16_t millivolts = sensors_.battery_millivolts();
  if (!battery_alarm_.update(millivolts, parameters_[kBatteryAlarm], now_ms)) return;
  lowering_ = armed();
  lowering_since_ms_ = now_ms;
  link_.queue_event(BoardEventKind::kBattery, lowering_, millivolts);
  report_disarmed(arming_.fail_battery());
}

void Robot::watch_leak() {
  if (leak_alarm_.update(board::leak())) report_disarmed(arming_.fail_leak());
}

uint32_t Robot::faults() const {
  const uint32_t leak = leak_alarm_.on() ? static_cast<uint32_t>(DeviceFault::kLeak) : 0;
  return leak | sensors_.faults() | fins_.faults();
}

Motion Robot::motion(uint32_t now_ms) {
  if (armed()) return arming_.commanded() ? Motion::kSwim : Motion::kRest;
  if (lowering_ && now_ms - lowering_since_ms_ >= kLoweringMs) lowering_ = false;
  return lowering_ ? Motion::kDown : Motion::kOff;
}

void Robot::send_telemetry() {
  Imu imu;
  if (has_imu(slot_) && sensors_.take(&imu)) link_.send(imu);
  if (has_motor(slot_)) {
    Motor motor;
    fins_.report(&motor);
    link_.send(motor);
  }
  Depth depth;
  if (has_depth(slot_) && sensors_.take(&depth, parameters_[kWaterDensity])) link_.send(depth);
  if (slot_ == kBeaconSlot) {
    Beacon beacon;
    sensors_.read(&beacon);
    link_.send(beacon);
  }
  // Events wait for a host: at power-on the encoders are not ready yet, and what they lack fills the queue.
  if (slot_ == kStatusSlot && arming_.greeted()) report_changed_faults();
  // On a slow line the status slot may be far away, and the host that armed the board waits for the status.
  if (slot_ == kStatusSlot || (kSlow && armed() != reported_armed_)) send_status();
  link_.flush();
}

void Robot::send_status() {
  Status status;
  status.time = board::microseconds();
  status.epoch = epoch_;
  status.flags = flags();
  status.faults = faults();
  status.reset_cause = static_cast<uint8_t>(board::reset_cause());
  status.battery = sensors_.battery_millivolts();
  status.loop_worst = loop_worst_;
  status.missed_ticks = missed_ticks_;
  status.frames_invalid = link_.frames_invalid();
  status.bytes_lost = board::bytes_lost();
  status.debug_lost = link_.lines_lost();
  status.stack_free = board::stack_free();
  loop_worst_ = 0;
  reported_armed_ = armed();
  link_.send(status);
}

uint8_t Robot::flags() const {
  return bit(StatusFlag::kArmed, armed()) | bit(StatusFlag::kHostAlive, arming_.host_alive()) |
         bit(StatusFlag::kNeutral, fins_.neutral()) | bit(StatusFlag::kMotorPower, fins_.powered()) |
         bit(StatusFlag::kBatteryLow, battery_alarm_.on()) |
         bit(StatusFlag::kDefinitionsDiffer, arming_.definitions_differ()) |
         bit(StatusFlag::kHil, in_the_loop());
}

}  // namespace mucat
