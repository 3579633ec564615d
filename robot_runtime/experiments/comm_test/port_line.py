"""A host at a real serial port, in real time."""

import time
from contextlib import ExitStack
from pathlib import Path

from robot_runtime.experiments.comm_test.line import Cancellation, CommTestLine, check
from robot_runtime.experiments.comm_test.results import FaultCounts, LineErrors
from robot_runtime.experiments.line_faults.pty_proxy import PtyProxy, execute
from robot_runtime.link.port import Port

LOOK = 0.1
"""s between two looks whether somebody wants it to stop."""


class PortLine(CommTestLine):
    """The port at `path`, opened `boot_time` s before the test's time begins; earlier bytes are dropped.

    With `folder`, a place for its link, a line with faults is put before the port. Raises PortError and
    StoppedError.
    """

    start_time = 0.0

    def __init__(
        self, path: str, baud: int, boot_time: float, stop: Cancellation, folder: Path | None
    ) -> None:
        super().__init__(baud)
        self._stop = stop
        self._faulty: PtyProxy | None = None
        self._began = time.monotonic()
        with ExitStack() as stack:
            if folder:
                self._faulty = stack.enter_context(PtyProxy(path, baud, folder / "faulty"))
                path = str(folder / "faulty")
            self._port = stack.enter_context(Port(path, baud))
            self._pass(boot_time)
            self._files = stack.pop_all()
        self.heard = b""
        self.now = 0.0
        self._began = time.monotonic()

    def close(self) -> None:
        """Close the port."""
        self._files.close()

    def errors(self) -> LineErrors:
        """Return the injected faults; the errors that the UARTs saw are not known."""
        if self._faulty is None:
            return LineErrors()
        return LineErrors(faults=FaultCounts.add_up(self._faulty.stats()))

    def _order(self, command: str) -> None:
        assert self._faulty
        execute(self._faulty, command)

    def _hand_over(self, data: bytes) -> None:
        self._port.write(data)
        self.written += len(data)

    def _pass(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while (remaining := end - time.monotonic()) > 0:
            check(self._stop)
            if self._port.wait(min(remaining, LOOK)):
                self.heard += self._port.read()
        self.now = time.monotonic() - self._began
