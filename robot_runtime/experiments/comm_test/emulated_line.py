"""A host at the serial port of a paused emulated board: time passes only while the host waits."""

from pathlib import Path

from robot_runtime.experiments.comm_test.line import (
    TIME_MIN,
    WRITE_BUFFER_BYTES,
    Cancellation,
    CommTestLine,
    check,
)
from robot_runtime.experiments.comm_test.results import FaultCounts, LineErrors
from robot_runtime.simulation.boards.emulated_board import PausedPort
from robot_runtime.simulation.boards.emulator_process import EmulatorClient

READ_STEP_BYTES = 1024


class EmulatedLine(CommTestLine):
    """The port at `tty` of a paused board, whose power is switched off and on once the port is open.

    So the board's past makes no difference, except for its memories. Raises BoardError and PortError.
    """

    start_time = 0.02

    def __init__(self, board: EmulatorClient, tty: Path, baud: int, stop: Cancellation | None = None) -> None:
        super().__init__(baud)
        self._board = board
        self._stop = stop or Cancellation()
        self._port = PausedPort(board, tty, baud)

    def close(self) -> None:
        """Close the port."""
        self._port.close()

    def errors(self) -> LineErrors:
        """Return the errors that both UARTs counted since the start, and the injected faults."""
        stats = {name: int(value) for name, value in self._board.stats().items()}
        return LineErrors(
            framing_board=stats["framing_errors_board"],
            framing_host=stats["framing_errors_host"],
            overruns=stats["overruns"],
            faults=FaultCounts.add_up(stats),
        )

    def _order(self, command: str) -> None:
        self._board.command(command)

    def _hand_over(self, data: bytes) -> None:
        # With faults the line carries more or fewer bytes than were written: a write takes an unknown time.
        while self._port.count("waiting") + len(data) > WRITE_BUFFER_BYTES:
            self.wait(len(data) * self.byte_time)
        self._port.write(data)
        self.written += len(data)

    def _pass(self, seconds: float) -> None:
        end = self.now + seconds
        step = READ_STEP_BYTES * self.byte_time
        while (remaining := end - self.now) > TIME_MIN:
            check(self._stop)
            self.now = self._board.run(min(remaining, step))
            self.heard += self._port.receive()
