// The fuzz target for libFuzzer: the whole firmware on the board in memory, and the properties that must hold
// for any input on the line. Address and undefined-behaviour sanitisers check the rest.
//
// An input is a list of actions, each a byte (modulo 8) and its arguments. Frames get their checksum and
// stuffing here, so that mutated content reaches the code behind these. A control byte of 0 is the right one.
//
// - 0 MS: MS + 1 milliseconds pass
// - 1 SIZE bytes: these bytes come over the line
// - 2 CONTROL NUMBER COUNT packets: a frame of the session; a packet is the index of its type and its payload
// - 3 CONTROL NUMBER COUNT packets: an open frame
// - 4 SIZE bytes: a frame of the session with any content
// - 5 EPOCH: a HELLO with the right definitions
// - 6 CONTROL: a START for this boot
// - 7 CAUSE: the board resets
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "../board.h"
#include "link/crc32.h"
#include "link/frame.h"
#include "robot.h"

namespace mucat {
namespace {

constexpr uint8_t kTypes[] = {
    Stop::kType,      Start::kType,       Navigation::kType, Imu::kType,         Depth::kType,
    Beacon::kType,    Motor::kType,       Debug::kType,      Hello::kType,       Status::kType,
    Heartbeat::kType, Acknowledge::kType, Parameter::kType,  Calibration::kType, RequestCalibration::kType,
    ZeroDepth::kType, Sense::kType,       Countdown::kType};
constexpr uint32_t kLongestMs = 3000;
constexpr uint32_t kStepUs = 1000;
constexpr uint16_t kBatteryFull = 818;

void require(bool condition) {
  if (!condition) abort();
}

class Input {
 public:
  Input(const uint8_t* bytes, size_t size) : at_(bytes), end_(bytes + size) {}
  bool empty() const { return at_ == end_; }
  uint8_t byte() { return empty() ? 0 : *at_++; }
  std::vector<uint8_t> bytes(size_t maximum) {
    const size_t size = std::min<size_t>(maximum, end_ - at_);
    at_ += size;
    std::vector<uint8_t> bytes;
    bytes.reserve(maximum + 1);  // never a null pointer
    bytes.assign(at_ - size, at_);
    return bytes;
  }

 private:
  const uint8_t* at_;
  const uint8_t* end_;
};

// Checks the board's output: whole frames, and lines of text in order.
class Listener {
 public:
  void begin(uint32_t key) {
    in_session_ = true;
    decoder_.set_key(key);
    expected_ = 0;
    line_us_ = 0;
  }
  uint8_t expected() const { return expected_; }

  void receive(uint8_t byte) {
    const uint16_t invalid = decoder_.invalid();
    if (decoder_.feed(byte)) take();
    require(decoder_.invalid() == invalid);
  }

 private:
  void take() {
    require(!decoder_.reliable() || decoder_.open() != in_session_);
    const bool next = decoder_.number() == expected_;
    if (decoder_.reliable() && next) expected_ = (expected_ + 1) & 15;
    for (Message message; decoder_.next(&message);) {
      if (message.type != Debug::kType) continue;
      Debug line;
      memcpy(&line, message.payload, message.size);
      for (uint8_t i = 0; i < line.text_size; ++i) require(line.text[i] >= ' ' && line.text[i] <= '~');
      if (!next) continue;
      require(line.time >= line_us_);
      line_us_ = line.time;
    }
  }

  FrameDecoder decoder_;
  bool in_session_ = false;
  uint32_t line_us_ = 0;
  uint8_t expected_ = 0;
};

class FuzzRun {
 public:
  FuzzRun() {
    host::the_board = host::Board();
    host::the_board.battery = kBatteryFull;
    reset(ResetCause::kPowerOn);
  }

  void act(Input* input) {
    switch (input->byte() % 8) {
      case 0:
        advance(1 + input->byte());
        break;
      case 1:
        deliver(input->bytes(input->byte()));
        break;
      case 2:
        deliver(packets(input, key_));
        break;
      case 3:
        deliver(packets(input, kOpen));
        break;
      case 4: {
        std::vector<uint8_t> content = input->bytes(input->byte() % (kBlockBytesMax - kCrcBytes + 1));
        if (!content.empty()) deliver(frame(content, key_));
        break;
      }
      case 5:
        greet(input->byte());
        break;
      case 6:
        start(input->byte());
        break;
      default:
        reset(static_cast<ResetCause>(input->byte() % 5));
    }
  }

  bool over() const { return elapsed_ms_ >= kLongestMs; }

 private:
  void reset(ResetCause cause) {
    host::reset(cause);
    robot_.reset(new Robot);
    robot_->start();
    host::the_board.to_host.clear();
    // The board's decoder restarts, and so does this copy of it.
    at_board_ = FrameDecoder();
    key_ = kOpen;
    number_ = 0;
    listener_ = Listener();
    require(!robot_->armed() && !host::the_board.motor_power);
  }

  void advance(uint32_t ms) {
    elapsed_ms_ += ms;
    while (ms--) {
      host::advance(kStepUs);
      const bool armed = robot_->armed();
      robot_->step();
      require(armed || !robot_->armed());
      check();
    }
  }

  // Delivers bytes and runs the board at once, so that its state shows the effect of each frame.
  void deliver(const std::vector<uint8_t>& bytes) {
    host::Board& board = host::the_board;
    for (uint8_t byte : bytes) {
      board.to_board.push_back(byte);
      if (byte != 0) continue;
      const bool armed = robot_->armed();
      receive();
      require(armed || !robot_->armed() || started_);
      require(!stopped_ || started_ || !robot_->armed());
    }
    receive();
  }

  void receive() {
    started_ = stopped_ = false;
    while (!host::the_board.to_board.empty()) {
      for (uint8_t byte : host::the_board.to_board) {
        if (at_board_.feed(byte)) note();
        if (byte == 0) break;
      }
      robot_->step();
      check();
    }
  }

  // Notes the content of the frame that the board reads next.
  void note() {
    const bool in_session = at_board_.open() == (key_ == kOpen);
    if (in_session && at_board_.reliable() && at_board_.number() == (number_ & 15)) ++number_;
    uint32_t key = key_;
    for (Message message; at_board_.next(&message);) {
      if (message.type == Debug::kType) require(message.size <= sizeof(Debug));
      if (message.type == Stop::kType) stopped_ = true;
      if (message.type == Start::kType) started_ |= read<Start>(message).epoch == host::the_board.epoch;
      if (message.type == Hello::kType) key = session_key(read<Hello>(message).epoch, host::the_board.epoch);
    }
    if (key == key_) return;
    // Waiting bytes belong to the previous session.
    for (uint8_t byte : host::the_board.waiting) host::the_board.to_host.push_back(byte);
    host::the_board.waiting.clear();
    check();
    key_ = key;
    number_ = 0;
    at_board_.set_key(key);
    listener_.begin(key);
  }

  template <typename Packet>
  static Packet read(const Message& message) {
    Packet packet;
    memcpy(&packet, message.payload, sizeof packet);
    return packet;
  }

  void check() {
    host::Board& board = host::the_board;
    require(board.overwritten == 0);
    require(board.waiting.size() <= board::kLineRoom);
    for (uint8_t byte : board.to_host) listener_.receive(byte);
    board.to_host.clear();
  }

  void greet(uint8_t epoch) {
    FramePacker packer;
    const Hello hello = {kDefinitionsHash, epoch, board::kLineRoom};
    packer.add(Hello::kType, &hello, sizeof hello);
    deliver(close(&packer, 0, 0, kOpen));
  }

  void start(uint8_t control) {
    FramePacker packer;
    const Start start = {host::the_board.epoch};
    packer.add(Start::kType, &start, sizeof start);
    deliver(close(&packer, control, number_, key_));
  }

  std::vector<uint8_t> packets(Input* input, uint32_t key) {
    const uint8_t control = input->byte();
    uint16_t number = input->byte();
    FramePacker packer;
    bool reliable = false;
    for (uint8_t count = 1 + input->byte() % 8; count > 0 && !input->empty(); --count) {
      const uint8_t type = kTypes[input->byte() % sizeof kTypes];
      std::vector<uint8_t> payload;
      if (type == Debug::kType) {
        payload = input->bytes(offsetof(Debug, text_size));
        payload.resize(offsetof(Debug, text_size));
        const std::vector<uint8_t> text = input->bytes(input->byte() % (Debug::kTextMax + 1));
        payload.push_back(static_cast<uint8_t>(text.size()));
        payload.insert(payload.end(), text.begin(), text.end());
      } else {
        payload = input->bytes(payload_bytes(type));
        payload.resize(payload_bytes(type));
      }
      if (!packer.fits(static_cast<uint8_t>(payload.size()))) break;
      if (packer.empty()) reliable = is_reliable(type);
      packer.add(type, payload.data(), static_cast<uint8_t>(payload.size()));
    }
    if (packer.empty()) return {};
    if (reliable) number = number_;
    return close(&packer, control, number, key);
  }

  std::vector<uint8_t> close(FramePacker* packer, uint8_t control, uint16_t number, uint32_t key) {
    uint8_t bytes[kFrameBytesMax];
    const uint8_t acknowledged = (listener_.expected() + control) & 15;
    const uint8_t size = packer->close((number + (control >> 4)) & 4095, acknowledged, key, bytes);
    return std::vector<uint8_t>(bytes, bytes + size);
  }

  static std::vector<uint8_t> frame(std::vector<uint8_t> content, uint32_t key) {
    const uint32_t crc = crc32(content.data(), static_cast<uint8_t>(content.size())) ^ key;
    for (uint8_t i = 0; i < kCrcBytes; ++i) content.push_back(static_cast<uint8_t>(crc >> 8 * i));
    std::vector<uint8_t> stuffed(content.size() + kCobsOverhead);
    encode_cobs(content.data(), static_cast<uint8_t>(content.size()), stuffed.data());
    stuffed.push_back(0);
    return stuffed;
  }

  std::unique_ptr<Robot> robot_;
  FrameDecoder at_board_;
  bool started_ = false;
  bool stopped_ = false;
  Listener listener_;
  uint32_t key_ = kOpen;
  uint16_t number_ = 0;
  uint32_t elapsed_ms_ = 0;
};

}  // namespace
}  // namespace mucat

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  mucat::Input input(bytes, size);
  mucat::FuzzRun run;
  while (!input.empty() && !run.over()) run.act(&input);
  return 0;
}
