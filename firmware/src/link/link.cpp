#include "link/link.h"

#include "link/baud.h"

namespace mucat {
namespace {

constexpr uint8_t kNumberMask = 15;
constexpr uint16_t kUnreliableMask = 4095;
constexpr uint16_t kAcknowledgeMs = 20;
// The line is idle if less waits than is sent within a tick, or less than a frame.
constexpr uint16_t kBytesPerTick = kBaud / 1000;
constexpr uint8_t kIdleRoom =
    board::kLineRoom - (kBytesPerTick < kFrameBytesMax ? kBytesPerTick : kFrameBytesMax);

// More than the ring holds, because the decoder empties it: bytes are lost only if the main loop is away for
// the time of 255 bytes on the line. Four of the longest frames are in flight until the first is
// acknowledged, the fifth if that acknowledgement is lost.
constexpr uint16_t kCredit = 5 * kFrameBytesMax;
// As in robot_runtime/link/channel.py.
constexpr uint8_t kLimitMin = 16;
constexpr uint8_t kLimitLoss = 8;
constexpr uint8_t kLimitGain = 2;

bool is_before(uint8_t order, uint8_t other) { return static_cast<int8_t>(order - other) < 0; }

}  // namespace

bool Link::receive() {
  for (uint8_t byte; board::read_line(&byte);) {
    if (decoder_.feed(byte)) {
      in_order_ = restored_ = false;
      if (in_session()) {
        handle_acknowledgement();
        if (decoder_.reliable()) accept_reliable_frame();
      }
      return true;
    }
    // Returning after every frame, valid or not, keeps a flood of bytes from blocking the main loop.
    if (byte == 0) return false;
  }
  return false;
}

bool Link::next(Message* message) {
  do {
    while (decoder_.next(message)) {
      if (message->type == Hello::kType || message->type == Stop::kType) return true;
      if (!in_session()) continue;
      if (message->type == Acknowledge::kType) {
        if (!restored_) handle_selective_acknowledgement(message->payload[0]);
      } else if (in_order_ || !is_reliable(message->type)) {
        return true;
      }
    }
  } while (next_reordered());
  return false;
}

bool Link::next_reordered() {
  if (!in_order_ || unready_ || !reorder_buffer_.take(expected_, &decoder_)) return false;
  restored_ = true;
  expected_ = (expected_ + 1) & kNumberMask;
  return true;
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
  order_ = 0;
  newest_order_ = 0;
  shortened_ = 0;
  expected_ = 0;
  reorder_buffer_.clear();
  acknowledge_ = false;
  refused_ = false;
  announce_readiness_ = false;
}

void Link::set_ready(bool ready) {
  unready_ = !ready;
  if (ready && refused_) {
    refused_ = false;
    announce_readiness_ = true;
  }
}

void Link::accept_reliable_frame() {
  if (!acknowledge_) received_ms_ = board::milliseconds();
  acknowledge_ = true;
  if (unready_) {
    refused_ = announce_readiness_ = true;
    return;
  }
  const uint8_t ahead = (decoder_.number() - expected_) & kNumberMask;
  in_order_ = ahead == 0;
  if (in_order_) {
    reorder_buffer_.forget(expected_);
    expected_ = (expected_ + 1) & kNumberMask;
  } else if (ahead < kWindow && !decoder_.has(Start::kType)) {
    reorder_buffer_.insert(decoder_);
  }
}

void Link::handle_acknowledgement() {
  uint8_t count = (decoder_.acknowledged() - base_) & kNumberMask;
  if (count > in_flight_) return;  // an old one
  base_ = decoder_.acknowledged();
  uint8_t bytes = 0;
  for (uint8_t i = 0; i < count; ++i) {
    const Flight& flight = flights_[i];
    bytes += flight.bytes;
    if (!flight.received) note_arrival(flight);
  }
  queue_.drop(bytes);
  messages_bytes_ -= bytes;
  in_flight_ -= count;
  for (uint8_t i = 0; i < in_flight_; ++i) flights_[i] = flights_[i + count];
  // While a host was away, so many copies may have been sent that the order has wrapped past it.
  if (in_flight_ == 0) newest_order_ = order_;
  note_losses();
}

void Link::handle_selective_acknowledgement(uint8_t received) {
  if (decoder_.acknowledged() != base_) return;  // an old one
  for (uint8_t i = 1; i < in_flight_; ++i) {
    Flight& flight = flights_[i];
    if (flight.received || !(received >> (i - 1) & 1)) continue;
    note_arrival(flight);
    flight.received = true;
  }
  note_losses();
}

void Link::note_arrival(const Flight& flight) {
  // It is unknown which of several copies arrived: the first is the safe assumption.
  if (is_before(newest_order_, flight.first_order)) newest_order_ = flight.first_order;
  shortened_ = shortened_ > kLimitGain ? shortened_ - kLimitGain : 0;
  if (flight.order == flight.first_order) {
    round_trip_.measure(static_cast<uint16_t>(board::milliseconds()) - flight.sent_ms);
  }
}

void Link::note_losses() {
  for (uint8_t i = 0; i < in_flight_; ++i) {
    Flight& flight = flights_[i];
    if (!flight.received && is_before(flight.order, newest_order_)) flight.lost = true;
  }
}

void Link::put(uint8_t type, const void* payload, uint8_t size) {
  if (!packer_.fits(size)) flush();
  packer_.add(type, payload, size);
}

void Link::flush() {
  add_selective_acknowledgement();
  flush(key_);
}

// Adds the numbers of stored frames to the frame being packed, if there is room.
void Link::add_selective_acknowledgement() {
  if (!reorder_buffer_.any() || packer_.empty() || !packer_.fits(sizeof(Acknowledge))) return;
  // Not by send(), which may flush.
  const Acknowledge acknowledge = state();
  packer_.add(Acknowledge::kType, &acknowledge, sizeof acknowledge);
}

void Link::flush(uint32_t key) {
  if (packer_.empty()) return;
  if (board::line_room() < packer_.line_bytes()) {
    packer_.clear();
  } else {
    write(number_, key);
  }
  // A dropped frame uses up its number, so that the host counts it as missing.
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
  send(Hello{kDefinitionsHash, epoch, kCredit});
  if (board::line_room() < packer_.line_bytes()) {
    packer_.clear();
  } else {
    write(0, kOpen);
  }
}

void Link::queue_event(BoardEventKind kind, uint8_t detail, uint16_t value) {
  if (!queue(BoardEvent{board::microseconds(), static_cast<uint8_t>(kind), detail, value})) ++lines_lost_;
}

void Link::queue_line(DebugLine& line) {
  line.packet().time = board::microseconds();
  if (!queue_.push(Debug::kType, &line.packet(), debug_bytes(line.packet()))) ++lines_lost_;
}

bool Link::line_idle() { return board::line_room() >= kIdleRoom; }

bool Link::line_due(uint16_t now_ms) {
  uint16_t interval_ms = now_ms - stepped_ms_;
  stepped_ms_ = now_ms;
  // The longest frame takes 0.6 s at 1200 baud, and more than some seconds would overflow below.
  if (interval_ms > 1000) interval_ms = 1000;
  // Half a millisecond more, because the clock counts whole ones.
  const uint32_t bytes = (2UL * interval_ms + 1) * kBaud / 20000;
  return board::line_room() >= board::kLineRoom - (bytes < kFrameBytesMax ? bytes : kFrameBytesMax);
}

void Link::step(uint16_t now_ms) {
  if (!line_due(now_ms)) return;
  if (!announce_readiness_) {
    const uint16_t bytes = bytes_in_flight();
    if (repeat(now_ms, round_trip_.timeout(bytes)) || start_flight(now_ms)) return;
    const bool stalled = queue_.more_than(messages_bytes_);
    if (stalled && repeat(now_ms, round_trip_.stalled_timeout(bytes))) return;
    const bool late = static_cast<uint16_t>(now_ms - received_ms_) >= kAcknowledgeMs;
    if (!acknowledge_ || !(stalled || late)) return;
  }
  acknowledge();
}

void Link::acknowledge() {
  announce_readiness_ = false;
  send(state());
  flush(key_);
}

uint16_t Link::bytes_in_flight() const { return messages_bytes_ + in_flight_ * kFrameOverhead; }

bool Link::repeat(uint16_t now_ms, uint16_t timeout) {
  uint8_t offset = 0;
  for (uint8_t i = 0; i < in_flight_; ++i) {
    Flight& flight = flights_[i];
    const bool late = static_cast<uint16_t>(now_ms - flight.sent_ms) >= timeout;
    if (!flight.received && (flight.lost || late)) {
      pack(offset, flight.bytes);
      add_selective_acknowledgement();
      flight.sent_ms = now_ms;
      flight.order = ++order_;
      if (flight.lost) flight.first_order = flight.order;
      flight.lost = false;
      shortened_ =
          limit() > kLimitMin + kLimitLoss ? shortened_ + kLimitLoss : kReliableMessagesBytesMax - kLimitMin;
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
  const uint8_t room = kReliableMessagesBytesMax - (reorder_buffer_.any() ? 1 + sizeof(Acknowledge) : 0);
  const uint8_t bytes = pack(messages_bytes_, limit() < room ? limit() : room);
  if (bytes == 0) return false;
  add_selective_acknowledgement();
  ++order_;
  flights_[in_flight_] = Flight{now_ms, bytes, order_, order_, false, false};
  write((base_ + in_flight_) & kNumberMask, key_);
  ++in_flight_;
  messages_bytes_ += bytes;
  return true;
}

// Packs the messages from `offset` on into the frame, up to `limit` bytes but at least one message; returns
// their bytes.
uint8_t Link::pack(uint8_t offset, uint8_t limit) {
  uint8_t packed = 0;
  uint8_t message[kReliableBytesMax];
  while (packed < limit) {
    const uint8_t size = queue_.peek(offset + packed, message);
    if (size == 0 || (packed > 0 && packed + size > limit)) break;
    packer_.add(message[0], message + 1, size - 1);
    packed += size;
  }
  return packed;
}

}  // namespace mucat
