"""The water as a process, attached to the emulated board; it publishes and serves requests over Zenoh."""

import logging
import socket
import time
from collections.abc import Iterator, Mapping
from pathlib import Path

from robot_runtime.clock import Clock
from robot_runtime.contract.craft import DEFAULT_DOCUMENT, CraftDocument
from robot_runtime.contract.topics import CRAFT, TRUTH
from robot_runtime.simulation.boards.board_protocol import BoardLineError, LineBuffer, read_fins, write_sense
from robot_runtime.simulation.boards.stepped_board import PERIOD
from robot_runtime.simulation.water.craft_report import CraftReport
from robot_runtime.simulation.water.faults import DEVICES, LEAK, FaultOfDevice
from robot_runtime.simulation.water.requests import TRUTH_PERIOD, changes, serve_requests
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.transport.zenoh_transport import ZenohTransport

log = logging.getLogger(__name__)

RETRY = 0.2
"""s between two attempts to connect to the board."""
PATIENCE = 0.1
"""s of waiting for a silent board between two checks for the end."""


class WaterProcess:
    """The connection of the simulator, the emulated board's socket and the other processes."""

    def __init__(
        self,
        simulator: Simulator,
        board: Path,
        messages: ZenohTransport,
        clock: Clock,
        craft: CraftDocument = DEFAULT_DOCUMENT,
    ) -> None:
        self._simulator = simulator
        self._craft = CraftReport(simulator, craft)
        self._board = board
        self._outbox = serve_requests(messages, changes(simulator), clock)
        self._clock = clock
        self._truth_due = clock.now()
        self._ending = False
        self._attached: bool | None = None

    def run(self) -> None:
        """Simulate until `end` is called, with one board after another."""
        while not self._ending:
            try:
                with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as line:
                    line.settimeout(PATIENCE)
                    line.connect(str(self._board))
                    self._serve_board(line)
            except (OSError, BoardLineError) as problem:
                if self._attached is not False:
                    log.warning("no board at %s (%s); trying again until there is one", self._board, problem)
                self._attached = False
                time.sleep(RETRY)

    def end(self) -> None:
        """Make `run` return soon; may be called from a signal handler or any thread."""
        self._ending = True

    def _serve_board(self, line: socket.socket) -> None:
        line.sendall(f"attach {PERIOD}\n".encode())
        faults: dict[str, FaultOfDevice] | None = None
        for text in self._lines(line):
            if text.startswith("error"):
                log.warning("the board reports: %s", text)
                continue
            if text == "ok":
                # The answer to a fault.
                continue
            reading = self._simulator.advance(PERIOD, read_fins(text))
            now = self._clock.now()
            known, faults = faults, self._simulator.device_faults
            line.sendall((_write_faults(known, faults) + write_sense(reading)).encode())
            if not self._attached:
                log.info("attached to the board at %s", self._board)
            self._attached = True
            self._publish_truth(now)

    def _lines(self, line: socket.socket) -> Iterator[str]:
        lines = LineBuffer()
        while not self._ending:
            try:
                data = line.recv(4096)
            except TimeoutError:
                continue
            if not data:
                raise ConnectionError("it closed the connection")
            yield from filter(None, lines.feed(data))

    def _publish_truth(self, now: float) -> None:
        if now < self._truth_due:
            return
        self._truth_due += TRUTH_PERIOD
        if self._truth_due <= now:
            # The board was away, so that there is nothing to publish for that time.
            self._truth_due = now + TRUTH_PERIOD
        if (craft := self._craft.due(now)) is not None:
            self._outbox.add_document(CRAFT, craft)
        self._outbox.add_row(TRUTH, now, self._simulator.truth().to_bytes())
        self._outbox.flush()


def _write_faults(known: Mapping[str, FaultOfDevice] | None, faults: Mapping[str, FaultOfDevice]) -> str:
    """Return the commands that make devices fail or answer again; `known` are those set already.

    None where that is unknown: the board keeps the faults of a simulator that has ended.
    """
    begun = [f"fault {device} {fault}\n" for device, fault in sorted(faults.items() - (known or {}).items())]
    before = {*DEVICES.values(), LEAK} if known is None else known.keys()
    return "".join(begun + [f"fault {device} none\n" for device in sorted(before - faults.keys())])
