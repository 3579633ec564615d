"""Delivery of messages over a line that damages frames, without I/O and without a clock of its own.

A state machine for either end. Reliable messages arrive exactly once and in order; of unreliable ones the
newest of each type is sent, once, and not at all where it has waited too long.

Selective repeat: several messages share a frame, and reliable frames are numbered modulo 16. Up to seven are
in flight, and no more bytes than the other end can take in at once, though one frame always may. Seven and
not eight, so that the number in an acknowledgement always tells a new one from an old one that a noisy line
repeated. Every frame tells which reliable frame its sender waits for. One that holds later frames already
says which, in an ACKNOWLEDGE beside its other messages. A line keeps its order: what was sent before a frame
that has arrived, and has not arrived itself, is lost and goes out again at once (as in RFC 8985). Where no
news comes at all, the timeout of `RoundTrip` sends it again, for as long as it takes. Where the window is
full and more waits, a frame without news goes out again after one and a half mean round trips: the line has
nothing better to do.

Frames are as long as noise lets them be. It destroys long frames more often, and what a frame carries beside
its messages weighs more in short ones. Where errors are independent the sum is least where the share of
frames lost is the share of those 7 bytes in a frame: about a quarter at 26 bytes, a ninth at 64. So a lost
frame makes the next ones shorter by four times as much as another makes them longer, which is in balance
where one in five is lost.

A receiver may have no room to hold a frame out of order. It then drops it and does not name it, and it goes
out again as a lost one. The frame that the receiver waits for is never taken for held.

A receiver that has no room even for the next frame drops it and says so (Receive Not Ready, as in HDLC).
Nothing more is sent then until it says otherwise, but for the oldest frame now and then, in case that was
not heard.

Acknowledgements travel with whatever goes the other way, or alone when nothing does for a short while. Where
messages wait that may not go they do so at once: the line is free, and the other end may wait for them.

The line's pace is respected: a frame is handed over when the one before it has gone, so that what is urgent
never waits behind more than one frame. Unreliable messages go first, but never twice while reliable ones
wait: on a slow line they would fill it alone.
"""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice

from robot_runtime.contract.packets import NOT_READY, Acknowledge
from robot_runtime.link.framing import (
    MESSAGES_BYTES_MAX,
    OPEN,
    RELIABLE_NUMBERS,
    UNRELIABLE_NUMBERS,
    Frame,
    assemble,
)
from robot_runtime.link.round_trip import RoundTrip

WINDOW = 7
"""Reliable frames in flight, at most."""
EXPIRY = 0.3
"""s that an unreliable message may wait for the line."""
_ACKNOWLEDGE_DELAY = 0.005
_PROBE = 1.0
"""s between two tries at a receiver that has no room."""
_STALLED_WAIT = 1.5
"""Mean round trips."""
_LIMIT_MIN = 16
"""Bytes of messages in a frame that may always be."""
_LIMIT_LOSS = 8
"""Bytes by which frames get shorter where one is lost."""
_LIMIT_GAIN = 2
"""Bytes by which they get longer where one arrives at once."""
_FRAME_OVERHEAD = 7
_BITS_PER_BYTE = 10
_NEVER = float("inf")


@dataclass(slots=True)
class Counters:
    """Counters since the port was opened."""

    bytes_sent: int = 0
    bytes_delivered: int = 0
    frames_received: int = 0
    frames_sent: int = 0
    frames_missed: int = 0
    frames_repeated: int = 0
    frames_duplicate: int = 0
    messages_discarded: int = 0


@dataclass(slots=True)
class _Flight:
    """A reliable frame that is not acknowledged; `order` counts every transmission of the channel.

    Copies from `first_order` to `order` may have arrived; those before are known to be lost.
    """

    messages: list[bytes]
    sent: float
    first_order: int
    order: int
    held: bool = False
    lost: bool = False

    @property
    def size(self) -> int:
        return sum(map(len, self.messages)) + _FRAME_OVERHEAD


class Channel:
    """One end of one session, for a line of this many baud."""

    def __init__(
        self,
        baud: int,
        credit: int,
        key: int = OPEN,
        counters: Counters | None = None,
    ) -> None:
        self.counters = counters or Counters()
        self.round_trip = RoundTrip(baud)
        self.credit = credit
        self.key = key
        self._second_per_byte = _BITS_PER_BYTE / baud
        self._line_free = float("-inf")
        self._waiting: deque[bytes] = deque()
        self._flights: deque[_Flight] = deque()
        self._base = 0
        self._limit = MESSAGES_BYTES_MAX
        self._order = 0
        self._newest_order = -1
        self._ready = True
        self._latest: dict[int, tuple[bytes, float]] = {}
        self._reliable_next = False
        self._number = 0
        self._expected = 0
        self._held: dict[int, Frame] = {}
        self._last_number: int | None = None
        self._acknowledge_at = _NEVER

    @property
    def free_at(self) -> float:
        """The time at which the line will have sent all written bytes."""
        return self._line_free

    @property
    def urgent(self) -> bool:
        """True if an acknowledgement is due in either direction."""
        return bool(self._flights or self._waiting) or self._acknowledge_at < _NEVER

    def pending(self) -> list[bytes]:
        """Return the reliable messages that are not acknowledged, oldest first."""
        return [message for flight in self._flights for message in flight.messages] + list(self._waiting)

    def queue(self, message: bytes) -> None:
        """Send a reliable message (type and payload) as soon as its turn comes."""
        self._waiting.append(message)

    def offer(self, message: bytes, now: float) -> None:
        """Send an unreliable message (type and payload) soon, in place of an older one of its type."""
        self._latest[message[0]] = (message, now)

    def replace(self, old: bytes, new: bytes) -> None:
        """Replace every unacknowledged copy of a message by another of the same length."""
        self._waiting = deque(new if message == old else message for message in self._waiting)
        for flight in self._flights:
            flight.messages = [new if message == old else message for message in flight.messages]

    def timeout(self) -> float:
        """Return the time (s) after which an unacknowledged frame is sent again."""
        return self.round_trip.timeout(self._in_flight() * self._second_per_byte)

    def due(self) -> float:
        """Return the time of the next `poll` if nothing else happens; infinity for none."""
        if self._latest or self._may_send_new():
            return self._line_free
        if self._ready and any(flight.lost for flight in self._flights):
            return self._line_free
        wait = self._patience()
        timers = (flight.sent + wait for flight in self._repeatable() if not flight.held)
        return max(min(self._acknowledge_at, *timers, _NEVER), self._line_free)

    def receive(self, frame: Frame, now: float) -> list[tuple[int, bytes]]:
        """Take a frame of the session; return the messages that it completes, in order."""
        self.counters.frames_received += 1
        held = next((payload[0] for type_, payload in frame.messages if type_ == Acknowledge.type), None)
        self._take_acknowledgement(frame.acknowledged, held or 0, now)
        if held is not None:
            self._take_readiness(held & NOT_READY == 0)
        accepted = self._take_reliable(frame, now) if frame.reliable else self._take_unreliable(frame)
        messages = [
            message for each in accepted for message in each.messages if message[0] != Acknowledge.type
        ]
        self.counters.bytes_delivered += sum(len(payload) for _, payload in messages)
        return messages

    def poll(self, now: float) -> bytes:
        """Return the frame that is due, or no bytes. Call it again until it returns no bytes."""
        if now < self._line_free:
            return b""
        reliable_first, self._reliable_next = self._reliable_next, False
        data = b"" if reliable_first else self._send_latest(now)
        if data:
            self._reliable_next = True
        else:
            data = self._send_lost(now) or self._send_new(now) or self._send_latest(now)
        if not data and now >= self._acknowledge_at:
            data = self._send_unreliable(self._acknowledge())
        if data:
            self._acknowledge_at = _NEVER
            self.note_sent(len(data), now)
        return data

    def forget_number(self) -> None:
        """Accept the next unreliable frame with any number: the numbers may have gone round."""
        self._last_number = None

    def note_sent(self, size: int, now: float) -> None:
        """Note that a frame of this size was written to the line."""
        self._line_free = max(now, self._line_free) + size * self._second_per_byte
        self.counters.frames_sent += 1
        self.counters.bytes_sent += size

    # Sending

    def _patience(self) -> float:
        """Return the time (s) to wait for an acknowledgement: below the timeout where the line would idle."""
        if not self._ready:
            return _PROBE
        if self._waiting and self.round_trip.mean > 0 and not self._may_send_new():
            return min(_STALLED_WAIT * self.round_trip.mean, self.timeout())
        return self.timeout()

    def _repeatable(self) -> Iterable[_Flight]:
        return self._flights if self._ready else islice(self._flights, 1)

    def _in_flight(self) -> int:
        return sum(flight.size for flight in self._flights if not flight.held)

    def _may_send_new(self) -> bool:
        if not self._waiting or not self._ready or len(self._flights) >= WINDOW:
            return False
        size = sum(map(len, self._gather(take=False))) + _FRAME_OVERHEAD
        in_flight = self._in_flight()
        return in_flight == 0 or in_flight + size <= self.credit

    def _gather(self, take: bool) -> list[bytes]:
        """Return the waiting messages that fit a frame beside its acknowledgements; one at least."""
        room = min(self._limit, MESSAGES_BYTES_MAX - len(self._acknowledge_held()))
        chosen: list[bytes] = []
        for message in self._waiting:
            room -= len(message)
            if room < 0 and chosen:
                break
            chosen.append(message)
        if take:
            for _ in chosen:
                self._waiting.popleft()
        return chosen

    def _send_latest(self, now: float) -> bytes:
        messages = b""
        for type_, (message, offered) in list(self._latest.items()):
            if now - offered <= EXPIRY:
                if len(messages) + len(message) >= MESSAGES_BYTES_MAX:
                    break
                messages += message
            del self._latest[type_]
        if not messages:
            return b""
        held = self._acknowledge_held()
        if len(messages) + len(held) < MESSAGES_BYTES_MAX:
            messages += held
        return self._send_unreliable(messages)

    def _send_unreliable(self, messages: bytes) -> bytes:
        frame = assemble(messages, False, self._number, self._expected, self.key)
        self._number = (self._number + 1) % UNRELIABLE_NUMBERS
        return frame

    def _send_lost(self, now: float) -> bytes:
        wait = self._patience()
        for index, flight in enumerate(self._repeatable()):
            if flight.held or not ((flight.lost and self._ready) or now >= flight.sent + wait):
                continue
            flight.sent, flight.order = now, self._next_order()
            if flight.lost:
                flight.first_order, flight.lost = flight.order, False
            self._limit = max(self._limit - _LIMIT_LOSS, _LIMIT_MIN)
            self.counters.frames_repeated += 1
            return self._frame(index)
        return b""

    def _send_new(self, now: float) -> bytes:
        if not self._may_send_new():
            return b""
        order = self._next_order()
        self._flights.append(_Flight(self._gather(take=True), now, order, order))
        return self._frame(len(self._flights) - 1)

    def _next_order(self) -> int:
        self._order += 1
        return self._order

    def _frame(self, index: int) -> bytes:
        messages = b"".join(self._flights[index].messages)
        held = self._acknowledge_held()
        if len(messages) + len(held) <= MESSAGES_BYTES_MAX:
            messages += held
        number = (self._base + index) % RELIABLE_NUMBERS
        return assemble(messages, True, number, self._expected, self.key)

    def _acknowledge_held(self) -> bytes:
        return self._acknowledge() if self._held else b""

    def _acknowledge(self) -> bytes:
        ahead = ((number - self._expected - 1) % RELIABLE_NUMBERS for number in self._held)
        return bytes([Acknowledge.type, sum(1 << index for index in ahead)])

    # Receiving

    def _take_acknowledgement(self, expected: int, held: int, now: float) -> None:
        count = (expected - self._base) % RELIABLE_NUMBERS
        if count > len(self._flights):
            return  # an old one
        for _ in range(count):
            self._note_arrival(self._flights.popleft(), now)
        self._base = expected
        if self._flights:
            self._flights[0].held = False
        for index, flight in enumerate(self._flights):
            if index > 0 and held >> (index - 1) & 1 and not flight.held:
                self._note_arrival(flight, now)
                flight.held = True
        for flight in self._flights:
            flight.lost |= not flight.held and flight.order < self._newest_order

    def _take_readiness(self, ready: bool) -> None:
        if ready and not self._ready:
            # The receiver has dropped the frames that were sent meanwhile.
            for flight in self._flights:
                flight.lost = not flight.held
        self._ready = ready

    def _note_arrival(self, flight: _Flight, now: float) -> None:
        if flight.held:
            return
        # It is not known which of several copies arrived: the first is the safe assumption.
        self._newest_order = max(self._newest_order, flight.first_order)
        self._limit = min(self._limit + _LIMIT_GAIN, MESSAGES_BYTES_MAX)
        if flight.order == flight.first_order:
            self.round_trip.measure(now - flight.sent)

    def _take_reliable(self, frame: Frame, now: float) -> list[Frame]:
        delay = 0.0 if self._waiting else _ACKNOWLEDGE_DELAY
        self._acknowledge_at = min(self._acknowledge_at, now + delay)
        ahead = (frame.number - self._expected) % RELIABLE_NUMBERS
        if ahead >= WINDOW or frame.number in self._held:
            self.counters.frames_duplicate += 1
            return []
        self._held[frame.number] = frame
        ready: list[Frame] = []
        while self._expected in self._held:
            ready.append(self._held.pop(self._expected))
            self._expected = (self._expected + 1) % RELIABLE_NUMBERS
        return ready

    def _take_unreliable(self, frame: Frame) -> list[Frame]:
        if self._last_number is not None:
            missed = (frame.number - self._last_number - 1) % UNRELIABLE_NUMBERS
            if missed >= UNRELIABLE_NUMBERS // 2:
                self.counters.frames_duplicate += 1
                return []
            self.counters.frames_missed += missed
        self._last_number = frame.number
        return [frame]
