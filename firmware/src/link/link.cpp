#include "link/link.h"

#include "link/baud.h"

namespace mucat {
namespace {

constexpr uint8_t kNumberMask = 15;
constexpr uint16_t kUnreliableMask = 4095;
constexpr uint16_t kAcknowledgeMs = 20;
constexpr uint16_t kFrameOverhead = kFrameBytesMax - kMessagesBytesMax;
// No more waits than leaves within a tick, or a frame.
constexpr uint16_t kBytesPerTick = kBaud / 1000;
constexpr uint8_t kCalmRoom =
    board::kLineCredit - (kBytesPerTick < kFrameBytesMax ? kBytesPerTick : kFrameBytesMax);

}  // namespace

bool Link::receive() {
  for (uint8_t byte; board::read_line(&byte);) {
    if (decoder_.feed(byte)) {
      fresh_ = false;
      if (in_session()) {
        take_acknowledgement();
        if (decoder_.reliable()) take_number();
      }
      return true;
    }
    // Ending here at every frame, valid or not, keeps a flood of bytes from holding up the main loop.
    if (byte == 0) return false;
  }
  return false;
}

bool Link::next(Message* message) {
  while (decoder_.next(message)) {
    if (message->type == Hello::kType || message->type == Stop::kType) return true;
    if (!in_session()) continue;
    if (message->type == Acknowledge::kType) {
      take_held(message->payload[0]);
    } else if (fresh_ || !is_reliable(message->type)) {
      return true;
    }
  }
  return false;
}

void Link::answer(const Hello& hello, uint16_t epoch) {
  begin(session_key(hello.epoch, epoch));
  credit_ = hello.credit;
  greet(epoch);
}

void Link::begin(uint32_t key) {
  if (key == key_) return;
  key_ = key;
  decoder_.set_key(key);
  number_ = 0;
  in_flight_ = 0;
  messages_bytes_ = 0;
  base_ = 0;
  expected_ = 0;
  acknowledge_ = false;
  refused_ = false;
  tell_ready_ = false;
}

void Link::set_ready(bool ready) {
  ready_ = ready;
  if (ready && refused_) {
    refused_ = false;
    tell_ready_ = true;
  }
}

void Link::take_number() {
  if (!acknowledge_) heard_ms_ = board::milliseconds();
  acknowledge_ = true;
  fresh_ = ready_ && decoder_.number() == expected_;
  if (!ready_) refused_ = tell_ready_ = true;
  if (fresh_) expected_ = (expected_ + 1) & kNumberMask;
}

void Link::take_acknowledgement() {
  uint8_t count = (decoder_.acknowledged() - base_) & kNumberMask;
  if (count > in_flight_) return;  // an old one
  base_ = decoder_.acknowledged();
  uint8_t bytes = 0;
  for (uint8_t i = 0; i < count; ++i) {
    const Flight& flight = flights_[i];
    bytes += flight.bytes;
    // By Karn's rule: of a frame sent twice nobody knows which copy was heard.
    if (!flight.again && !flight.held) {
      round_trip_.measure(static_cast<uint16_t>(board::milliseconds()) - flight.sent_ms);
    }
  }
  queue_.drop(bytes);
  messages_bytes_ -= bytes;
  in_flight_ -= count;
  for (uint8_t i = 0; i < in_flight_; ++i) flights_[i] = flights_[i + count];
}

void Link::take_held(uint8_t held) {
  uint8_t missing = in_flight_;
  for (uint8_t i = in_flight_; i-- > 1;) {
    if (!(held >> (i - 1) & 1)) continue;
    flights_[i].held = true;
    if (missing == in_flight_) missing = i;
  }
  if (missing == in_flight_) return;
  // A repeated one may be on its way after the later one: only its timer tells.
  for (uint8_t i = 0; i < missing; ++i) flights_[i].lost = !flights_[i].held && !flights_[i].again;
}

void Link::put(uint8_t type, const void* payload, uint8_t size) {
  if (!packer_.fits(size)) flush();
  packer_.add(type, payload, size);
}

void Link::flush(uint32_t key) {
  if (packer_.empty()) return;
  if (board::line_room() < packer_.line_bytes()) {
    packer_.clear();
  } else {
    write(number_, key);
  }
  // A dropped frame has a number too, so that the host counts it.
  number_ = (number_ + 1) & kUnreliableMask;
}

void Link::write(uint16_t number, uint32_t key) {
  uint8_t frame[kFrameBytesMax];
  const uint8_t size = packer_.close(number, expected_, key, frame);
  board::write_line(frame, size);
  acknowledge_ = false;
}

void Link::greet(uint16_t epoch) {
  flush();
  send(Hello{kDefinitionsHash, epoch, board::kLineCredit});
  if (board::line_room() < packer_.line_bytes()) {
    packer_.clear();
  } else {
    write(0, kOpen);
  }
}

void Link::say(DebugLine& line) {
  line.packet().time = board::microseconds();
  if (!queue_.push(Debug::kType, &line.packet(), debug_bytes(line.packet()))) ++lines_lost_;
}

bool Link::calm() { return board::line_room() >= kCalmRoom; }

void Link::step(uint16_t now_ms) {
  if (!calm()) return;
  const bool late = acknowledge_ && static_cast<uint16_t>(now_ms - heard_ms_) >= kAcknowledgeMs;
  if (!tell_ready_ && (repeat(now_ms) || start_flight(now_ms) || !late)) return;
  acknowledge();
}

void Link::acknowledge() {
  tell_ready_ = false;
  send(Acknowledge{refused_ ? kNotReady : uint8_t{0}});
  flush();
}

uint16_t Link::bytes_in_flight() const { return messages_bytes_ + in_flight_ * kFrameOverhead; }

bool Link::repeat(uint16_t now_ms) {
  const uint16_t timeout = round_trip_.timeout(bytes_in_flight());
  uint8_t offset = 0;
  for (uint8_t i = 0; i < in_flight_; ++i) {
    Flight& flight = flights_[i];
    const bool late = static_cast<uint16_t>(now_ms - flight.sent_ms) >= timeout;
    if (!flight.held && (flight.lost || late)) {
      pack(offset, flight.bytes);
      flight.sent_ms = now_ms;
      flight.again = true;
      flight.lost = false;
      ++repeated_;
      write((base_ + i) & kNumberMask, key_);
      return true;
    }
    offset += flight.bytes;
  }
  return false;
}

bool Link::start_flight(uint16_t now_ms) {
  if (in_flight_ == kWindow) return false;
  if (in_flight_ > 0 && bytes_in_flight() + kFrameBytesMax > credit_) return false;
  const uint8_t bytes = pack(messages_bytes_, MessageQueue::kBytes);
  if (bytes == 0) return false;
  flights_[in_flight_] = Flight{now_ms, bytes, false, false, false};
  write((base_ + in_flight_) & kNumberMask, key_);
  ++in_flight_;
  messages_bytes_ += bytes;
  return true;
}

// Puts the messages from there on into the frame in the making, up to that many bytes or as many as fit;
// returns their bytes.
uint8_t Link::pack(uint8_t offset, uint8_t limit) {
  uint8_t packed = 0;
  uint8_t message[kReliableBytesMax];
  while (packed < limit) {
    const uint8_t size = queue_.peek(offset + packed, message);
    if (size == 0 || !packer_.fits(size - 1)) break;
    packer_.add(message[0], message + 1, size - 1);
    packed += size;
  }
  return packed;
}

}  // namespace mucat
