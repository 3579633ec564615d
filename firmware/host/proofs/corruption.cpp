#include "corruption.h"

#include <math.h>

#include <algorithm>

namespace mucat {
namespace host {
namespace {

constexpr uint8_t kTypes[] = {Start::kType,     Navigation::kType, Imu::kType,   Depth::kType,
                              Beacon::kType,    Motor::kType,      Debug::kType, Status::kType,
                              Heartbeat::kType, Acknowledge::kType};
constexpr uint32_t kBurstBits = 64;
constexpr uint32_t kGarbageBytes = 200;

// An accepted frame: its bytes on the line, and its decoded contents.
struct AcceptedFrame {
  std::vector<uint8_t> bytes;
  std::vector<uint8_t> contents;
  bool operator==(const AcceptedFrame& other) const {
    return bytes == other.bytes && contents == other.contents;
  }
};

std::vector<uint8_t> contents(FrameDecoder* decoder) {
  std::vector<uint8_t> all{decoder->open(), decoder->reliable(), decoder->acknowledged(), decoder->number()};
  for (Message message; decoder->next(&message);) {
    all.push_back(message.type);
    all.insert(all.end(), message.payload, message.payload + message.size);
  }
  return all;
}

std::vector<AcceptedFrame> read_all(const std::vector<uint8_t>& line, uint32_t key) {
  FrameDecoder decoder;
  decoder.set_key(key);
  std::vector<AcceptedFrame> frames;
  auto start = line.begin();
  for (auto at = line.begin(); at != line.end(); ++at) {
    if (decoder.feed(*at)) frames.push_back({{start, at}, contents(&decoder)});
    if (*at == 0) start = at + 1;
  }
  return frames;
}

}  // namespace

Corruption::Corruption(Damage damage, double rate, uint64_t seed)
    : damage_(damage),
      rate_(rate),
      random_(seed),
      host_epoch_(static_cast<uint16_t>(random_())),
      board_epoch_(static_cast<uint16_t>(1 + below(UINT16_MAX))),
      key_(session_key(host_epoch_, board_epoch_)) {}

void Corruption::carry(uint32_t frames) {
  line_.clear();
  sent_bytes_.clear();
  damaged_.clear();
  damaged_frames_ = 0;
  foreign_ = 0;
  while (damaged_frames_ + foreign_ < frames) damage_one();
}

Counts Corruption::read() const {
  const std::vector<AcceptedFrame> sent = read_all(sent_bytes_, key_);
  Counts counts = {damaged_frames_ + foreign_, 0, 0};
  size_t next = 0;
  for (const AcceptedFrame& frame : read_all(line_, key_)) {
    const auto found = std::find(sent.begin() + next, sent.end(), frame);
    if (found == sent.end()) {
      ++counts.undetected;
      continue;
    }
    ++counts.accepted;
    const size_t at = found - sent.begin();
    if (damaged_[at]) --counts.corrupted;
    next = at + 1;
  }
  return counts;
}

// A random number in (0, 1].
double Corruption::uniform() { return (static_cast<double>(random_() >> 11) + 1) / 9007199254740992.0; }

// A random frame of a session, of one to five packets. Every other one has many zeros, for COBS.
Corruption::Bytes Corruption::frame(uint32_t key) {
  const uint32_t zeros = chance(2) ? 3 : 256;
  FramePacker packer;
  const uint32_t count = 1 + below(5);
  bool reliable = false;
  for (uint32_t i = 0; i < count; ++i) {
    const uint8_t type = kTypes[below(sizeof kTypes)];
    if (!packer.empty() && is_reliable(type) != reliable && type != Acknowledge::kType) continue;
    if (packer.empty()) reliable = is_reliable(type);
    uint8_t payload[sizeof(Debug)];
    for (uint8_t& byte : payload) byte = chance(zeros) ? 0 : static_cast<uint8_t>(random_());
    uint8_t size;
    if (type == Debug::kType) {
      Debug* const line = reinterpret_cast<Debug*>(payload);
      line->text_size = static_cast<uint8_t>(below(Debug::kTextMax + 1));
      size = static_cast<uint8_t>(sizeof(Debug) - Debug::kTextMax + line->text_size);
    } else {
      size = static_cast<uint8_t>(payload_bytes(type));
    }
    if (packer.fits(size)) packer.add(type, payload, size);
  }
  uint8_t bytes[kFrameBytesMax];
  const uint16_t number = static_cast<uint16_t>(below(reliable ? 16 : 4096));
  const uint8_t size = packer.close(number, static_cast<uint8_t>(below(16)), key, bytes);
  return Bytes(bytes, bytes + size);
}

Corruption::Bytes Corruption::open_frame() {
  FramePacker packer;
  const Hello hello = {static_cast<uint32_t>(random_()), static_cast<uint16_t>(random_()),
                       static_cast<uint16_t>(random_())};
  if (chance(2)) {
    packer.add(Hello::kType, &hello, sizeof hello);
  } else {
    packer.add(Stop::kType, &hello, 0);
  }
  uint8_t bytes[kFrameBytesMax];
  const uint8_t size = packer.close(0, 0, kOpen, bytes);
  return Bytes(bytes, bytes + size);
}

// The key of a neighbouring session, of one with similar epochs, or of any.
uint32_t Corruption::neighbour() {
  uint16_t host = host_epoch_, board = board_epoch_;
  switch (below(4)) {
    case 0:
      host = static_cast<uint16_t>(host + (chance(2) ? 1 : -1));
      break;
    case 1:
      board = static_cast<uint16_t>(board + (chance(2) ? 1 : -1));
      break;
    case 2:
      (chance(2) ? host : board) ^= static_cast<uint16_t>(1 << below(16));
      break;
    default:
      host = static_cast<uint16_t>(random_());
      board = static_cast<uint16_t>(random_());
  }
  const uint32_t key = session_key(host, board);
  return key == key_ || key == kOpen ? neighbour() : key;
}

void Corruption::send(const Bytes& frame, bool damaged) {
  sent_bytes_.insert(sent_bytes_.end(), frame.begin(), frame.end());
  damaged_.push_back(damaged);
  damaged_frames_ += damaged;
}

void Corruption::put(const Bytes& bytes) { line_.insert(line_.end(), bytes.begin(), bytes.end()); }

void Corruption::send_foreign(Bytes bytes) {
  put(bytes);
  ++foreign_;
}

void Corruption::flip_some(Bytes* bytes) {
  const uint32_t bits = 8 * static_cast<uint32_t>(bytes->size());
  std::vector<uint32_t> chosen;
  for (uint32_t remaining = 1 + below(4); remaining > 0;) {
    const uint32_t bit = below(bits);
    if (std::find(chosen.begin(), chosen.end(), bit) != chosen.end()) continue;
    chosen.push_back(bit);
    (*bytes)[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
    --remaining;
  }
}

void Corruption::damage_one() {
  switch (damage_) {
    case Damage::kBitErrors:
      bit_errors();
      break;
    case Damage::kBurst:
      burst();
      return;  // contains the next frame
    case Damage::kTruncated:
      truncate();
      break;
    case Damage::kJoined:
      join();
      break;
    case Damage::kGarbage:
      garbage();
      break;
    case Damage::kWrongChecksum:
      wrong_checksum();
      break;
    case Damage::kOtherSession:
      send_foreign(frame(neighbour()));
      break;
    case Damage::kOtherSessionBits: {
      Bytes bytes = frame(neighbour());
      flip_some(&bytes);
      send_foreign(bytes);
      break;
    }
    default:
      damage_bytes();
  }
  const Bytes whole = frame(key_);
  send(whole, false);
  put(whole);
}

void Corruption::bit_errors() {
  Bytes bytes = chance(8) ? open_frame() : frame(key_);
  send(bytes, true);
  const double bits = 8.0 * static_cast<double>(bytes.size());
  // Distances between errors are geometrically distributed; the first one is known to lie in the frame.
  const double none = log1p(-rate_);
  double at = floor(log1p(uniform() * expm1(bits * none)) / none);
  while (at < bits) {
    const uint32_t bit = static_cast<uint32_t>(at);
    bytes[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
    at += 1 + floor(log(uniform()) / none);
  }
  put(bytes);
}

void Corruption::burst() {
  const Bytes first = chance(8) ? open_frame() : frame(key_);
  const Bytes second = frame(key_);
  Bytes both = first;
  both.insert(both.end(), second.begin(), second.end());
  const Bytes before = both;
  const uint32_t from = below(8 * static_cast<uint32_t>(first.size()));
  const uint32_t to = std::min(from + 2 + below(kBurstBits - 1), 8 * static_cast<uint32_t>(both.size()));
  while (std::equal(first.begin(), first.end(), both.begin())) {
    both = before;
    for (uint32_t bit = from; bit < to; ++bit) both[bit / 8] ^= static_cast<uint8_t>(below(2) << bit % 8);
  }
  send(first, true);
  send(second, !std::equal(second.begin(), second.end(), both.begin() + first.size()));
  put(both);
}

void Corruption::damage_bytes() {
  Bytes bytes = chance(8) ? open_frame() : frame(key_);
  send(bytes, true);
  const uint32_t count = damage_ == Damage::kMoved ? 1 : 1 + below(3);
  for (uint32_t i = 0; i < count && !bytes.empty(); ++i) {
    const auto at = bytes.begin() + below(static_cast<uint32_t>(bytes.size()));
    if (damage_ == Damage::kInserted) {
      bytes.insert(at, static_cast<uint8_t>(random_()));
    } else if (damage_ == Damage::kDoubled) {
      const uint8_t byte = *at;
      bytes.insert(at, byte);
    } else {
      bytes.erase(at);
    }
  }
  if (damage_ == Damage::kMoved) {
    const Bytes& whole = bytes;
    const uint32_t at = below(static_cast<uint32_t>(whole.size()) + 1);
    bytes.insert(bytes.begin() + at, static_cast<uint8_t>(random_()));
  }
  put(bytes);
}

void Corruption::truncate() {
  const Bytes bytes = chance(8) ? open_frame() : frame(key_);
  send(bytes, true);
  const uint32_t cut = 1 + below(static_cast<uint32_t>(bytes.size()) - 2);
  if (chance(2)) {
    put(Bytes(bytes.begin(), bytes.begin() + cut));
    put({0});
  } else {
    put(Bytes(bytes.begin() + cut, bytes.end()));
  }
}

void Corruption::join() {
  const Bytes first = frame(key_);
  const Bytes second = frame(key_);
  send(first, true);
  send(second, true);
  put(Bytes(first.begin(), first.begin() + 1 + below(static_cast<uint32_t>(first.size()) - 1)));
  put(Bytes(second.begin() + below(static_cast<uint32_t>(second.size()) - 1), second.end()));
}

void Corruption::garbage() {
  const uint32_t zeros = chance(2) ? 24 : 256;
  Bytes bytes(1 + below(kGarbageBytes));
  for (uint8_t& byte : bytes) byte = chance(zeros) ? 0 : static_cast<uint8_t>(random_());
  bytes.push_back(0);
  for (size_t i = 1; i < bytes.size(); ++i) foreign_ += bytes[i] == 0 && bytes[i - 1] != 0;
  put(bytes);
}

void Corruption::wrong_checksum() {
  Bytes content[2] = {frame(key_), frame(key_)};
  for (Bytes& bytes : content)
    bytes.resize(decode_cobs(bytes.data(), static_cast<uint8_t>(bytes.size() - 1)));
  std::copy(content[1].end() - kCrcBytes, content[1].end(), content[0].end() - kCrcBytes);
  Bytes stuffed(content[0].size() + kCobsOverhead);
  encode_cobs(content[0].data(), static_cast<uint8_t>(content[0].size()), stuffed.data());
  stuffed.push_back(0);
  send_foreign(stuffed);
}

}  // namespace host
}  // namespace mucat
