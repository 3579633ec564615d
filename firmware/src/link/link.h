// The board's end of the serial line: frames in, frames out. Never waits.
//
// Telemetry is sent once. Lines of text and all else that is queued are reliable, and arrive exactly once and
// in order: they stay in their queue until they are acknowledged, and the queue is the only store of what is
// in flight. Up to seven reliable frames are, of several messages each, numbered modulo 16, and no more bytes
// than the host can take in. A line keeps its order: what was sent before a frame that has arrived, and has
// not arrived itself, is lost and goes out again at once. Any other does after the timeout of RoundTrip, for
// as long as it takes, or where the line would idle after one and a half mean round trips. Frames are as
// long as noise lets them be; robot_runtime/link/channel.py, the other end, has the theory.
//
// Of the host's reliable frames the next in order is taken. Later ones are held as far as there is room, and
// the host is told which; never START, since a STOP must be able to make it void as long as it is not taken.
// What is taken is acknowledged by the next frame of telemetry, or by a frame of its own.
//
// A session begins with a HELLO that carries another epoch than the last. Its frames have a key made of both
// epochs, so that none from before a restart is believed. Of open frames only HELLO and STOP are taken then.
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
  // Takes bytes from the line up to the end of one frame; true where that frame is valid.
  bool receive();
  // The received frame's next message that is new; false after the last. Ask until then.
  bool next(Message* message);

  // Sets if the host's reliable messages are accepted, as they are at first. If not, the board reports "not
  // ready"; the host sends them again when the board is ready.
  void set_ready(bool ready);

  // Sends HELLO at once, in an open frame of its own; `epoch` is this boot of the board.
  void greet(uint16_t epoch);
  // The same as an answer. Where it is another session's, numbers start anew, and reliable messages that were
  // not acknowledged are sent again.
  void answer(const Hello& hello, uint16_t epoch);

  // Puts a packet into the frame in the making; closes that first where the packet does not fit.
  template <typename Packet>
  void send(const Packet& packet) {
    put(Packet::kType, &packet, sizeof packet);
  }
  // Closes the frame in the making. Where the line has no room for it, it is dropped: what it held is old by
  // the time there is.
  void flush();

  // True if the line would send new bytes soon.
  static bool line_idle();

  // Queues a reliable packet of fixed length; false where there is no room for it.
  template <typename Packet>
  bool queue(const Packet& packet) {
    static_assert(is_reliable(Packet::kType), "only reliable packets are queued");
    return queue_.push(Packet::kType, &packet, sizeof packet);
  }
  // Queues a line of text; where there is no room it is dropped and counted.
  void say(DebugLine& line);
  // Sends one frame of reliable messages, or an acknowledgement, where one is due and the line is idle.
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
    // Of every transmission. Copies from the first to the last may have arrived; those before are lost.
    uint8_t first_order;
    uint8_t order;
    bool held : 1;  // the host has it, but not one before it
    bool lost : 1;  // the host has what was sent later
  };

  void begin(uint32_t key);
  void put(uint8_t type, const void* payload, uint8_t size);
  void flush(uint32_t key);
  void write(uint16_t number, uint32_t key);
  bool in_session() const { return decoder_.open() == (key_ == kOpen); }
  void take_number();
  void take_acknowledgement();
  void take_selective_acknowledgement(uint8_t held);
  bool next_reordered();
  Acknowledge state() const { return Acknowledge{refused_ ? kNotReady : reorder_buffer_.after(expected_)}; }
  void note_arrival(const Flight& flight);
  void note_losses();
  void add_selective_acknowledgement();
  uint16_t bytes_in_flight() const;
  bool repeat(uint16_t now_ms, uint16_t timeout);
  bool start_flight(uint16_t now_ms);
  uint8_t pack(uint8_t offset, uint8_t limit);

  FrameDecoder decoder_;
  FramePacker packer_;
  MessageQueue queue_;
  ReorderBuffer reorder_buffer_;
  RoundTrip round_trip_;
  Flight flights_[kWindow];
  uint32_t key_ = kOpen;
  uint16_t credit_ = kFrameBytesMax;
  uint16_t number_ = 0;                        // of the next unreliable frame
  uint16_t repeated_ = 0;                      // reliable frames
  uint16_t lines_lost_ = 0;                    // for want of room
  uint8_t in_flight_ = 0;                      // reliable frames
  uint8_t messages_bytes_ = 0;                 // of messages in flight
  uint8_t base_ = 0;                           // number of the oldest in flight
  uint8_t order_ = 0;                          // of the newest transmission
  uint8_t newest_order_ = 0;                   // of what has arrived
  uint8_t limit_ = kReliableMessagesBytesMax;  // bytes of messages in a new frame
  uint8_t expected_ = 0;                       // number of the host's next reliable frame
  bool ready_ = true;
  bool refused_ = false;         // a reliable frame since it was last ready
  bool announce_ready_ = false;  // with the next step
  bool fresh_ = false;           // the received frame's reliable messages are new
  bool put_back_ = false;        // it was held: what it acknowledges is old
  bool acknowledge_ = false;
  uint16_t received_ms_ = 0;
};

}  // namespace mucat
