// The board's end of the serial link: frames in, frames out. Never waits.
//
// Sending. Telemetry is sent once. Queued messages, such as events, are reliable: they arrive exactly
// once and in order. They stay in their queue, the only store, until they are acknowledged. Up to seven
// reliable frames, numbered modulo 16, are in flight, with no more bytes than the host has granted.
//
// Retransmission. The line keeps the order of frames. So a frame is lost if a later one has arrived, and goes
// out again at once. Any other goes out again after the timeout of RoundTrip, without limit; if the line
// would otherwise be idle, after one and a half mean round trips. Losses make new frames shorter.
// robot_runtime/link/channel.py, the other end, explains the method.
//
// Receiving. The host's next reliable frame in order is accepted. Later ones are stored if there is room, and
// the host is told which. A frame with START is never stored, because a STOP must be able to void it until it
// is accepted. The next frame of telemetry, or a frame of its own, acknowledges.
//
// Sessions. A HELLO with a new epoch begins a session. Its frames have a key of both epochs, so that no frame
// from before a restart is accepted. Of open frames only HELLO and STOP are accepted then.
#pragma once
#include <stdint.h>

#include "board/board.h"
#include "link/debug.h"
#include "link/frame.h"
#include "link/message_queue.h"
#include "link/reorder_buffer.h"
#include "link/round_trip.h"
#include "packets.gen.h"

namespace mucat {

class Link {
 public:
  // Reads bytes from the line up to the end of one frame; true if that frame is valid.
  bool receive();
  // The received frame's next new message; false after the last. Call it until then.
  bool next(Message* message);

  // Sets if the host's reliable messages are accepted, as they are at first. If not, the board reports "not
  // ready"; the host sends them again when the board is ready.
  void set_ready(bool ready);

  // Sends HELLO at once, in an open frame of its own; `epoch` is this boot of the board.
  void greet(uint16_t epoch);
  // Answers a HELLO. In a new session the numbers start again, and reliable messages that were not
  // acknowledged are sent again.
  void answer(const Hello& hello, uint16_t epoch);

  // Packs a packet into the current frame; sends that first if the packet does not fit.
  template <typename Packet>
  void send(const Packet& packet) {
    put(Packet::kType, &packet, sizeof packet);
  }
  // Sends the current frame. If the line has no room, the frame is dropped: its content would be old later.
  void flush();

  // True if the line would send new bytes soon.
  static bool line_idle();

  // Queues a reliable packet of fixed length; false if there is no room for it.
  template <typename Packet>
  bool queue(const Packet& packet) {
    static_assert(is_reliable(Packet::kType), "only reliable packets are queued");
    return queue_.push(Packet::kType, &packet, sizeof packet);
  }
  // Queues an event; without room it is dropped and counted.
  void queue_event(BoardEventKind kind, uint8_t detail = 0, uint16_t value = 0);
  // Queues a line of text; without room it is dropped and counted.
  void queue_line(DebugLine& line);
  // Sends one frame of reliable messages, or an acknowledgement, if one is due and the line has sent most of
  // what waited. Call it at a steady pace.
  void step(uint16_t now_ms);

  // Sends an acknowledgement now. Call it regularly if nothing else is sent: the host treats a board that is
  // silent for 1 s as lost.
  void acknowledge();

  uint16_t frames_invalid() const { return decoder_.invalid(); }
  uint16_t frames_repeated() const { return repeated_; }
  uint16_t lines_lost() const { return lines_lost_; }

 private:
  static constexpr uint8_t kWindow = 7;
  struct Flight {
    uint16_t sent_ms;
    uint8_t bytes;  // of messages
    // Order of transmission, of the first copy that may have arrived, and of the last.
    uint8_t first_order;
    uint8_t order;
    bool received : 1;  // the host has it, but not one before it
    bool lost : 1;      // the host has a later one
  };

  void begin(uint32_t key);
  void put(uint8_t type, const void* payload, uint8_t size);
  void flush(uint32_t key);
  void write(uint16_t number, uint32_t key);
  bool in_session() const { return decoder_.open() == (key_ == kOpen); }
  void accept_reliable_frame();
  void handle_acknowledgement();
  void handle_selective_acknowledgement(uint8_t received);
  bool next_reordered();
  Acknowledge state() const { return Acknowledge{refused_ ? kNotReady : reorder_buffer_.after(expected_)}; }
  void note_arrival(const Flight& flight);
  void note_losses();
  void add_selective_acknowledgement();
  uint16_t bytes_in_flight() const;
  // True if no more bytes wait than the line sends until the next step, and at most a frame. The time until
  // then is assumed to be the time since the last step. More waiting bytes would make the round trip longer,
  // and under noise the window of seven short frames is too small for that.
  bool line_due(uint16_t now_ms);
  bool repeat(uint16_t now_ms, uint16_t timeout);
  bool start_flight(uint16_t now_ms);
  uint8_t pack(uint8_t offset, uint8_t limit);
  // Bytes of messages in a new frame.
  uint8_t limit() const { return kReliableMessagesBytesMax - shortened_; }

  FrameDecoder decoder_;
  FramePacker packer_;
  MessageQueue queue_;
  ReorderBuffer reorder_buffer_;
  RoundTrip round_trip_;
  Flight flights_[kWindow] = {};
  uint32_t key_ = kOpen;
  uint16_t credit_ = 0;         // bytes in flight; one frame always may be
  uint16_t number_ = 0;         // of the next unreliable frame
  uint16_t repeated_ = 0;       // reliable frames
  uint16_t lines_lost_ = 0;     // because the queue was full
  uint8_t in_flight_ = 0;       // reliable frames
  uint8_t messages_bytes_ = 0;  // of messages in flight
  uint8_t base_ = 0;            // number of the oldest in flight
  uint8_t order_ = 0;           // of the newest transmission
  uint8_t newest_order_ = 0;    // of what has arrived
  uint8_t shortened_ = 0;       // bytes that losses take from a new frame
  uint8_t expected_ = 0;        // number of the host's next reliable frame
  bool unready_ = false;
  bool refused_ = false;             // a reliable frame since it was last ready
  bool announce_readiness_ = false;  // with the next step
  bool in_order_ = false;            // the received frame's reliable messages are new
  bool restored_ = false;            // it was stored: its acknowledgement is old
  bool acknowledge_ = false;
  uint16_t received_ms_ = 0;
  uint16_t stepped_ms_ = 0;  // the last step()
};

}  // namespace mucat
