"""The connection to the board: a thread that opens the port, keeps the session, and never gives up."""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

from robot_runtime.clock import Clock
from robot_runtime.link.frame_ring import KeptFrame
from robot_runtime.link.port import Port, PortError
from robot_runtime.link.session import Message, Session, Stage
from robot_runtime.link.statistics import LinkStatistics
from robot_runtime.packets import Hello, Packet, Status, Stop
from robot_runtime.packets.layout import LayoutError

log = logging.getLogger(__name__)

_POLL = 0.05
_RETRY = 0.25
_PERIOD = 0.03


@dataclass(frozen=True, slots=True)
class Fault:
    """What went wrong at `time` (s), in words, and the last frames each way until then."""

    time: float
    text: str
    frames: list[KeptFrame]


class Connection:
    """Keeps a serial connection to the board alive.

    `on_messages` gets every batch of messages, `on_change` is called when the connection was established or
    lost; both run on the connection's own thread. `text` says how things stand, in words;
    `fault` is the last one.
    """

    def __init__(
        self,
        path: str,
        baud: int,
        clock: Clock,
        epoch: int,
        on_messages: Callable[[list[Message]], None],
        on_change: Callable[[], None],
    ) -> None:
        self.path = path
        self.baud = baud
        self.text = "not opened yet"
        self.fault: Fault | None = None
        self._clock = clock
        self._epoch = epoch
        self._on_messages = on_messages
        self._on_change = on_change
        self._port: Port | None = None
        self._session = Session(epoch, baud)
        self._faults = 0
        self._writing = threading.Lock()
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="link", daemon=True)

    @property
    def connected(self) -> bool:
        """Whether the board answers and speaks the same definitions."""
        return self._port is not None and self._session.stage is Stage.ESTABLISHED

    @property
    def board(self) -> Hello | None:
        """The greeting of the board that is connected now, or was last."""
        return self._session.board

    def start(self) -> None:
        """Begin to open the port."""
        self._thread.start()

    def close(self) -> None:
        """Close the port and end the thread."""
        self._ending.set()
        self._thread.join()

    def send(self, *packets: Packet) -> bool:
        """Hand these packets to the line; False where nobody is there to take them.

        Reliable ones arrive, once and in order, for as long as the connection lives. Of unreliable ones the
        newest of each type goes out once. STOP goes out at once, and also where no board has answered yet.
        """
        with self._writing:
            port = self._port
            stops = any(isinstance(packet, Stop) for packet in packets)
            if port is None or not (self.connected or stops):
                return False
            try:
                port.write(self._session.send(packets, self._clock.now()))
            except PortError as problem:
                log.warning("%s", problem)
                return False
        return True

    def statistics(self) -> LinkStatistics:
        """What the line carried since the port was opened."""
        return self._session.statistics()

    def frames(self) -> list[KeptFrame]:
        """The last frames each way since the port was opened, in the order of time."""
        with self._writing:
            return self._session.ring.frames()

    def _run(self) -> None:
        while not self._ending.is_set():
            try:
                with Port(self.path, self.baud) as port:
                    self._converse(port)
            except PortError as problem:
                self._tell(str(problem))
            self._port = None
            self._ending.wait(_RETRY)

    def _converse(self, port: Port) -> None:
        with self._writing:
            # Another epoch each time: the board must not take this for the conversation before.
            self._epoch = (self._epoch + 1) & 0xFFFF
            self._session = Session(self._epoch, self.baud)
            self._port = port
        stage = None
        try:
            while not self._ending.is_set():
                if self._session.stage is not stage:
                    if stage is Stage.ESTABLISHED:
                        self._dump("the connection was lost")
                    stage = self._session.stage
                self._tell(_words(stage, self._session))
                self._poll(port)
                self._await(port)
        except PortError:
            if stage is Stage.ESTABLISHED:
                self._dump("the port went away")
            raise
        finally:
            with self._writing:
                self._port = None

    def _await(self, port: Port) -> None:
        wait = max(min(self._session.due() - self._clock.now(), _POLL), 0.0)
        if self.connected and not self._session.urgent:
            # Frames come in pieces, a hundred a second; on a Pi it is the waking that costs.
            time.sleep(_PERIOD)
            wait = 0.0
        # An idle port and one that has gone both read as nothing; only the latter claims to be ready.
        if port.wait(wait):
            self._receive(port)

    def _receive(self, port: Port) -> None:
        data = port.read()
        with self._writing:
            discarded = self._session.counters.messages_discarded
            messages = self._session.receive(data, self._clock.now())
            discarded = self._session.counters.messages_discarded - discarded
        if discarded:
            log.warning("link: the board restarted; %d messages to it were not acknowledged", discarded)
        for message in messages:
            if message.type == Status.type:
                self._see_faults(Status.from_bytes(message.payload).faults)
        if messages:
            try:
                self._on_messages(messages)
            except LayoutError:
                log.exception("a packet could not be understood")

    def _see_faults(self, faults: int) -> None:
        if faults & ~self._faults:
            self._dump("the board reports a fault")
        self._faults = faults

    def _dump(self, why: str) -> None:
        with self._writing:
            ring = self._session.ring
            self.fault = Fault(self._clock.now(), why, ring.frames())
            dump = ring.dump()
        log.info("link: %s; the last frames, bytes as on the line:\n%s", why, dump)

    def _poll(self, port: Port) -> None:
        with self._writing:
            data = self._session.poll(self._clock.now())
            if data:
                port.write(data)

    def _tell(self, text: str) -> None:
        if text != self.text:
            self.text = text
            log.info("link: %s", text)
            self._on_change()


def _words(stage: Stage, session: Session) -> str:
    if stage is Stage.GREETING and session.garbled:
        return (
            "bytes come from the board, but no valid frame: does its firmware run at another speed than"
            f" link.baud, {session.baud} baud? `make firmware` builds it for that; then upload it"
        )
    if stage is not Stage.REFUSED or session.board is None:
        return stage.value
    return (
        f"{stage.value} (board {session.board.definitions:08x}): build and upload the firmware that"
        " belongs to this software with `make firmware`"
    )
