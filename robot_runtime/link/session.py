"""The session with the board, without I/O and without a clock of its own.

A session lasts from opening the port to closing it. The host sends HELLO until the board answers with the
same hash of the packet definitions. From then on the session is established, and a host with nothing else to
send sends a HEARTBEAT. After another hash only HELLO and STOP are sent.

Both HELLOs carry an epoch: a number of this boot, and one of this session. Together they are the key of the
session's frames, so that no frame from before a restart of either side is accepted. A board that restarts
sends HELLO with another epoch, and is greeted again. Messages that it had not acknowledged were meant for
its boot before; they are discarded and counted. A board that sends anything but HELLO in an open frame has
lost the session, and is greeted as well. After `SILENCE` without a valid frame the board counts as lost and
is greeted; if it did not restart, both sides continue where they were.

Within the session `Channel` delivers the messages. STOP does not use it: it is sent at once in an open frame,
which the board accepts in any state, and it voids every START that is not acknowledged yet.

`receive` takes bytes and the time; `poll` and `send` return bytes for the line.
"""

from collections.abc import Iterable
from dataclasses import asdict
from enum import Enum
from typing import NamedTuple

from robot_runtime.contract.link_statistics import LinkStatistics
from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    FRAME_BYTES_MAX,
    PACKETS,
    Heartbeat,
    Hello,
    Packet,
    Start,
    Stop,
    encode,
)
from robot_runtime.link.board_time import BoardTime
from robot_runtime.link.channel import Channel, Counters
from robot_runtime.link.frame_ring import FrameRing
from robot_runtime.link.framing import OPEN, Decoder, Frame, build
from robot_runtime.link.timing import frames_airtime

SILENCE = 1.0
"""s without a valid frame after which the board counts as lost; on a slow line, three frames' airtime."""
CREDIT = 4096
"""Bytes that the operating system keeps until the next look at the port."""
NO_BOOT = 0
"""The epoch of no board: a START with it is void."""
_GREETING = 0.25
_HEARTBEAT = 0.1
_GOODPUT_OVER = 1.0
_GARBLED_BYTES = 3 * FRAME_BYTES_MAX
_NUMBERS_LAST = 10.0
"""s of silence after which the numbers of unreliable frames may have gone half round, and then a new frame
cannot be told from an old one. A board sends 110 a second at most: 2048 in 18.6 s."""


class SessionStage(Enum):
    """The stage of a session."""

    GREETING = "waiting for the board's greeting"
    ESTABLISHED = "connected"
    REFUSED = "the board's firmware was built from other packet definitions"


class BoardMessage(NamedTuple):
    """One packet from the board, not yet decoded; `time` is when it was taken, in host seconds."""

    type: int
    payload: bytes
    time: float


def session_key(host_epoch: int, board_epoch: int) -> int:
    """Return the key of the frames between these two: both epochs, mixed by MurmurHash3's finaliser.

    Like epochs differ in few bits, and bit errors must not make up for it. Mixing by a CRC would not do, as
    some bit errors have the same effect. It is `OPEN` for epochs of 0 alone, and no boot is numbered 0.
    """
    key = host_epoch << 16 | board_epoch
    key = (key ^ key >> 16) * 0x85EBCA6B & 0xFFFFFFFF
    key = (key ^ key >> 13) * 0xC2B2AE35 & 0xFFFFFFFF
    return key ^ key >> 16


class LinkSession:
    """One session on a line of this many baud; `host_epoch` distinguishes it from every other."""

    def __init__(self, host_epoch: int, baud: int) -> None:
        self.stage = SessionStage.GREETING
        self.board: Hello | None = None
        self.counters = Counters()
        self.ring = FrameRing()
        self._epoch = host_epoch
        self.baud = baud
        self._silence = max(SILENCE, frames_airtime(3, baud))
        self._now = 0.0
        self._decoder = Decoder(seen=self._see)
        self._channel = Channel(baud, FRAME_BYTES_MAX, counters=self.counters)
        self._times = BoardTime()
        self._bytes_received = 0
        self._bytes_understood = 0
        self._last_frame_at = 0.0
        self._greeted_at: float | None = None
        self._greeting_seconds = 0.0
        self._sent = 0.0
        self._goodput = 0.0
        self._goodput_from = (0.0, 0)

    @property
    def garbled(self) -> bool:
        """True if bytes for some frames came and none of them was valid."""
        return self._bytes_received - self._bytes_understood >= _GARBLED_BYTES

    @property
    def urgent(self) -> bool:
        """True if an acknowledgement is due in either direction."""
        return self._channel.urgent

    def receive(self, data: bytes, now: float) -> list[BoardMessage]:
        """Return the messages that these bytes complete; greetings are handled here and passed on as well."""
        self._now = now
        self._bytes_received += len(data)
        messages: list[BoardMessage] = []
        for frame in self._decoder.feed(data):
            if now - self._last_frame_at > _NUMBERS_LAST:
                self._channel.forget_number()
            self._last_frame_at = now
            self._bytes_understood = self._bytes_received
            if frame.open:
                passed = self._take_open(frame, now)
            elif self.stage is SessionStage.REFUSED:
                passed = []
            else:
                # The board uses our epoch: it received our greeting, even if its answer was lost.
                self._establish(now)
                passed = self._channel.receive(frame, now)
            messages += [
                BoardMessage(type_, payload, self._stamp(type_, payload, now)) for type_, payload in passed
            ]
        return messages

    def poll(self, now: float, early: float = 0.0) -> bytes:
        """Return the bytes to send now: a greeting, queued messages, a heartbeat, or none.

        A heartbeat goes up to `early` (s) before it is due.
        """
        self._measure_goodput(now)
        if self.stage is SessionStage.ESTABLISHED and now - self._last_frame_at > self._silence:
            self.stage = SessionStage.GREETING
        if self.stage is not SessionStage.ESTABLISHED:
            if self._greeted_at is not None and now - self._greeted_at < _GREETING:
                return b""
            self._greeted_at = now
            return self._send_open(Hello(definitions=DEFINITIONS_HASH, epoch=self._epoch, credit=CREDIT), now)
        data = self._poll_channel(now)
        if now - self._sent >= _HEARTBEAT - early and now >= self._channel.free_at:
            self._channel.offer(encode(Heartbeat(time=int(now * 1000) & 0xFFFFFFFF)), now)
            data += self._poll_channel(now)
        return data

    def due(self) -> float:
        """Return the time of the next `poll` if nothing else happens."""
        if self.stage is not SessionStage.ESTABLISHED:
            return self._greeted_at + _GREETING if self._greeted_at is not None else float("-inf")
        heartbeat = max(self._sent + _HEARTBEAT, self._channel.free_at)
        return min(self._last_frame_at + self._silence, heartbeat, self._channel.due())

    def send(self, packets: Iterable[Packet], now: float) -> bytes:
        """Queue these packets; return the bytes to send now. Without a session only STOP is accepted."""
        data = b""
        for packet in packets:
            if isinstance(packet, Stop):
                self._void_starts()
                data += self._send_open(packet, now)
            elif self.stage is SessionStage.ESTABLISHED:
                self._queue(packet, now)
        return data + self.poll(now) if self.stage is SessionStage.ESTABLISHED else data

    def statistics(self) -> LinkStatistics:
        """Return the counters as a record."""
        trip = self._channel.round_trip
        return LinkStatistics(
            **asdict(self.counters),
            bytes_received=self._bytes_received,
            frames_invalid=self._decoder.invalid,
            round_trip=trip.mean or self._greeting_seconds,
            round_trip_deviation=trip.deviation,
            timeout=self._channel.timeout(),
            goodput=self._goodput,
            credit=self._channel.credit,
            clock_error=self._times.error,
            clock_drift=self._times.drift,
        )

    def _queue(self, packet: Packet, now: float) -> None:
        message = encode(packet)
        if not packet.reliable:
            self._channel.offer(message, now)
        elif message not in self._channel.pending():
            # A repetition of a message that is still unacknowledged adds nothing.
            self._channel.queue(message)

    def _void_starts(self) -> None:
        void = encode(Start(epoch=NO_BOOT))
        for message in self._channel.pending():
            if message[0] == Start.type:
                self._channel.replace(message, void)

    def _send_open(self, packet: Packet, now: float) -> bytes:
        frame = build([packet], 0, 0)
        self._channel.note_sent(len(frame), now)
        self._note_sent(frame, OPEN, now)
        return frame

    def _poll_channel(self, now: float) -> bytes:
        data = b""
        while frame := self._channel.poll(now):
            self._note_sent(frame, self._channel.key, now)
            data += frame
        return data

    def _note_sent(self, frame: bytes, key: int, now: float) -> None:
        self._sent = now
        self.ring.add_sent(frame, key, now)

    def _see(self, frame: bytes) -> None:
        self.ring.add_received(frame, self._decoder.key, self._now)

    def _take_open(self, frame: Frame, now: float) -> list[tuple[int, bytes]]:
        self.counters.frames_received += 1
        greetings = [message for message in frame.messages if message[0] == Hello.type]
        for _, payload in greetings:
            self._greet(Hello.from_bytes(payload), now)
        if not greetings and self.stage is SessionStage.ESTABLISHED:
            self.stage, self._greeted_at = SessionStage.GREETING, None
        return greetings

    def _greet(self, hello: Hello, now: float) -> None:
        known = (
            self.board is not None
            and self.board.epoch == hello.epoch
            and self.stage is not SessionStage.REFUSED
        )
        self.board = hello
        if hello.definitions != DEFINITIONS_HASH:
            self._begin_anew(hello)
            self.stage = SessionStage.REFUSED
        elif not known:
            self._begin_anew(hello)
        else:
            self._establish(now)

    def _begin_anew(self, hello: Hello) -> None:
        self.stage = SessionStage.GREETING
        self.counters.messages_discarded += len(self._channel.pending())
        self._decoder.key = session_key(self._epoch, hello.epoch)
        self._channel = Channel(self.baud, hello.credit, self._decoder.key, self.counters)
        self._times = BoardTime()
        self._greeted_at = None

    def _establish(self, now: float) -> None:
        if self.stage is SessionStage.GREETING:
            self.stage = SessionStage.ESTABLISHED
            if self._greeted_at is not None:
                self._greeting_seconds = now - self._greeted_at

    def _stamp(self, type_: int, payload: bytes, now: float) -> float:
        if "time" not in PACKETS[type_].wires:
            return now
        to_host = self._times.to_host_waiting if PACKETS[type_].reliable else self._times.to_host
        return to_host(int.from_bytes(payload[:4], "little"), now)

    def _measure_goodput(self, now: float) -> None:
        since, before = self._goodput_from
        if now - since >= _GOODPUT_OVER:
            self._goodput = (self.counters.bytes_delivered - before) / (now - since)
            self._goodput_from = now, self.counters.bytes_delivered
