// The robot's parts on the bench, each by itself.
#pragma once

#include <mucat.h>

#include "board/board.h"
#include "calibration.h"
#include "link/link.h"
#include "motor_jog.h"
#include "sensors/as5040.h"
#include "sensors/mpu6050.h"
#include "sensors/ms5837.h"

class Bench {
 public:
  void start() {
    mucat::board::start();
    store_.start();
    epoch_ = mucat::board::next_epoch();
    link_.greet(epoch_);
  }

  // One pass of the main loop, as Robot::step().
  void step() {
    if (link_.receive()) {
      for (mucat::Message message; link_.next(&message);) handle(message);
    }
    const uint8_t ticks = mucat::board::take_ticks();
    if (ticks == 0) {
      mucat::board::rest();
      return;
    }
    tick();
    mucat::board::feed_watchdog();
  }

 private:
  static constexpr uint8_t kTicksPerReport = 5;
  static constexpr uint8_t kFirstAddress = 0x08;  // those before and behind are reserved
  static constexpr uint8_t kLastAddress = 0x77;
  static constexpr uint8_t kAddressesPerTick = 8;
  // Until the H-bridges, which the motors' supply feeds, answer.
  static constexpr uint8_t kPowerTicks = 5;

  void handle(const mucat::Message &message) {
    switch (message.type) {
      case mucat::Hello::kType: {
        const mucat::Hello hello = mucat::unpack<mucat::Hello>(message);
        greeted_ = agreed_ = hello.definitions == mucat::kDefinitionsHash;
        jog_.stop();
        link_.answer(hello, epoch_);
        break;
      }
      case mucat::Stop::kType:
        jog_.stop();
        break;
      case mucat::Jog::kType:
        if (agreed_) jog_.drive(mucat::unpack<mucat::Jog>(message));
        break;
      case mucat::RequestScan::kType:
        // It switches the motors' power on.
        if (!agreed_) break;
        address_ = kFirstAddress;
        wait_ = kPowerTicks;
        memset(&scan_, 0, sizeof scan_);
        break;
      case mucat::Calibration::kType:
        if (agreed_) store_.store(mucat::unpack<mucat::Calibration>(message));
        break;
      case mucat::RequestCalibration::kType:
        store_.request();
        break;
      default:
        break;  // a heartbeat
    }
  }

  void tick() {
    jog_.step(address_ <= kLastAddress);
    if (address_ <= kLastAddress) scan();
    if (imu_.step(&imu_reading_)) imu_known_ = true;
    if (imu_.faulty()) imu_known_ = false;
    if (pressure_.step(&pressure_reading_)) pressure_known_ = true;
    if (pressure_.faulty()) pressure_known_ = false;
    store_.step();
    if (!greeted_) return;
    if (++tick_ == 1) mucat::board::start_battery();
    if (tick_ == kTicksPerReport) {
      tick_ = 0;
      report();
    }
    if (store_.answer_due() && link_.queue(store_.value())) store_.answered();
    if (scanned_ && link_.queue(scan_)) scanned_ = false;
    link_.step(mucat::board::milliseconds());
  }

  void scan() {
    if (wait_) {
      --wait_;
      return;
    }
    for (uint8_t i = 0; i < kAddressesPerTick; ++i, ++address_) {
      uint8_t byte;
      if (mucat::board::exchange_i2c(address_, nullptr, 0, &byte, 1)) {
        scan_.answered[address_ / 8] |= 1 << address_ % 8;
      }
    }
    scanned_ = address_ > kLastAddress;
  }

  void report() {
    mucat::Raw raw = {};
    raw.time = mucat::board::microseconds();
    for (uint8_t fin = 0; fin < mucat::kFinCount; ++fin) {
      raw.encoders[fin] = mucat::read_encoder_word(fin);
    }
    raw.identity = imu_.identity();
    if (imu_known_) {
      memcpy(raw.rate, imu_reading_.rate, sizeof raw.rate);
      memcpy(raw.force, imu_reading_.force, sizeof raw.force);
    }
    if (pressure_known_) {
      raw.pressure = pressure_reading_.pressure;
      raw.temperature = pressure_reading_.temperature;
    }
    raw.battery = mucat::board::take_battery();
    raw.beacons = mucat::board::beacon_right() | mucat::board::beacon_left() << 1;
    raw.leak = mucat::board::leak();
    link_.send(raw);
    link_.flush();
  }

  mucat::Link link_;
  mucat::CalibrationStore store_;
  MotorJog jog_;
  mucat::Mpu6050 imu_;
  mucat::ImuReading imu_reading_;
  mucat::Ms5837 pressure_;
  mucat::PressureReading pressure_reading_;
  mucat::Scan scan_;
  uint16_t epoch_ = 0;
  uint8_t address_ = kLastAddress + 1;
  uint8_t wait_ = 0;
  uint8_t tick_ = 0;
  bool scanned_ = false;
  bool greeted_ = false;
  bool agreed_ = false;
  bool imu_known_ = false;
  bool pressure_known_ = false;
};
