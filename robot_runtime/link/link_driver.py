"""The link to the board without its I/O: session, statistics, failures and messages."""

import logging
import threading
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from robot_runtime.clock import Clock
from robot_runtime.contract.link_statistics import LinkStatistics
from robot_runtime.contract.packets import Hello, Packet, Stop
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.link.dissection import dissect
from robot_runtime.link.frame_ring import RecordedFrame
from robot_runtime.link.session import BoardMessage, LinkSession, SessionStage
from robot_runtime.places import UPLOAD_REMEDY

log = logging.getLogger(__name__)

PERIOD = 0.03
"""s for which bytes accumulate while nothing is urgent. Frames come in pieces, a hundred a second, and each
wake-up costs CPU time on a Pi."""
_POLL = 0.05

Write = Callable[[bytes], None]


class PortError(Exception):
    """The port cannot be opened, or fails; the text says why and what to do."""


@dataclass(frozen=True, slots=True)
class LinkFailure:
    """A failure at `time` (s): its description, and the last frames in each direction."""

    time: float
    text: str
    frames: list[RecordedFrame]


class LinkDriver:
    """Driver of the session with the board, from one opening of the line to the next.

    `on_messages` gets every batch of messages, `on_change` is called when the connection was established or
    lost, both in the thread that calls `poll` and `receive`. `send`, `statistics` and `frames` may be called
    from any thread. `text` is the state in words; `fault` is the last failure.
    """

    def __init__(
        self,
        path: str,
        baud: int,
        clock: Clock,
        epoch: int,
        on_messages: Callable[[list[BoardMessage]], None],
        on_change: Callable[[], None],
    ) -> None:
        self.path = path
        self.baud = baud
        self.text = "not opened yet"
        self.fault: LinkFailure | None = None
        self._clock = clock
        self._epoch = epoch
        self._on_messages = on_messages
        self._on_change = on_change
        self._write: Write | None = None
        self._session = LinkSession(epoch, baud)
        self._stage: SessionStage | None = None
        self._faults = 0
        self._writing = threading.Lock()

    @property
    def connected(self) -> bool:
        """True if the board answers and was built from the same definitions."""
        return self._write is not None and self._session.stage is SessionStage.ESTABLISHED

    @property
    def board(self) -> Hello | None:
        """The greeting of the board that is connected now, or was last."""
        return self._session.board

    @property
    def gathering(self) -> bool:
        """True if bytes may accumulate for `PERIOD`, as nothing is urgent."""
        return self.connected and not self._session.urgent

    def send(self, *packets: Packet) -> bool:
        """Send these packets; return False when there is no connection.

        Reliable ones arrive, once and in order, for as long as the connection lives. Of unreliable ones the
        newest of each type goes out once. STOP goes out at once, and also where no board has answered yet.
        """
        with self._writing:
            write = self._write
            stops = any(isinstance(packet, Stop) for packet in packets)
            if write is None or not (self.connected or stops):
                return False
            try:
                write(self._session.send(packets, self._clock.now()))
            except PortError as problem:
                log.warning("%s", problem)
                return False
        return True

    def statistics(self) -> LinkStatistics:
        """Return the counters since the line was opened."""
        with self._writing:
            return self._session.statistics()

    def frames(self) -> list[RecordedFrame]:
        """Return the last frames in both directions since the line was opened, in order of time."""
        with self._writing:
            return self._session.ring.frames()

    def describe_frames(self) -> dict[str, Any]:
        """Return the last frames, now and at the last failure, as a JSON object."""
        fault = self.fault
        return {
            "time": self._clock.now(),
            "frames": [asdict(dissect(frame)) for frame in self.frames()],
            "fault": fault
            and {
                "time": fault.time,
                "text": fault.text,
                "frames": [asdict(dissect(frame)) for frame in fault.frames],
            },
        }

    def attach(self, write: Write) -> None:
        """Start a session on a line that `write` sends bytes to; `write` may raise PortError."""
        with self._writing:
            # A new epoch each time: the board must not take this for the session before.
            self._epoch = (self._epoch + 1) & 0xFFFF
            self._session = LinkSession(self._epoch, self.baud)
            self._write = write
        self._stage = None

    def detach(self) -> None:
        """End the use of the line."""
        with self._writing:
            self._write = None

    def record_loss(self) -> None:
        """Record the last frames when the port goes away while connected."""
        if self._stage is SessionStage.ESTABLISHED:
            self._dump("the port went away")

    def poll(self, early: float = 0.0) -> None:
        """Update the state and send what is due, a heartbeat up to `early` (s) before. Raise PortError."""
        if self._session.stage is not self._stage:
            if self._stage is SessionStage.ESTABLISHED:
                self._dump("the connection was lost")
            self._stage = self._session.stage
        self.report(_describe(self._stage, self._session))
        with self._writing:
            data = self._session.poll(self._clock.now(), early)
            if data and self._write is not None:
                self._write(data)

    def wait(self) -> float:
        """Return the s until `poll` must be called, unless bytes come."""
        with self._writing:
            due = self._session.due()
        return max(min(due - self._clock.now(), _POLL), 0.0)

    def receive(self, data: bytes) -> None:
        """Handle received bytes."""
        with self._writing:
            discarded = self._session.counters.messages_discarded
            messages = self._session.receive(data, self._clock.now())
            discarded = self._session.counters.messages_discarded - discarded
        if discarded:
            log.warning("link: the board restarted; %d messages to it were not acknowledged", discarded)
        if messages:
            try:
                self._on_messages(messages)
            except LayoutError:
                log.exception("a packet could not be understood")

    def see_faults(self, faults: int) -> None:
        """Keep the last frames where the board reports a new fault of a device."""
        if faults & ~self._faults:
            self._dump("the board reports a fault")
        self._faults = faults

    def report(self, text: str) -> None:
        """Report the state if it has changed."""
        if text != self.text:
            self.text = text
            log.info("link: %s", text)
            self._on_change()

    def _dump(self, why: str) -> None:
        with self._writing:
            ring = self._session.ring
            self.fault = LinkFailure(self._clock.now(), why, ring.frames())
            dump = ring.dump()
        log.info("link: %s; the last frames, bytes as on the line:\n%s", why, dump)


def _describe(stage: SessionStage, session: LinkSession) -> str:
    if stage is SessionStage.GREETING and session.garbled:
        return (
            "bytes come from the board, but no valid frame: its firmware may run at another speed than"
            f" link.baud, {session.baud} baud. Upload it anew: {UPLOAD_REMEDY}"
        )
    if stage is not SessionStage.REFUSED or session.board is None:
        return stage.value
    return (
        f"{stage.value} (board {session.board.definitions:08x}): upload the firmware that belongs"
        f" to this software: {UPLOAD_REMEDY}"
    )
