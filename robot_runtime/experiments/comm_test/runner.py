"""Runs a test's cells on the emulated board, in emulated time; the same test gives the same bytes.

A cell: compile, start a board with an empty flash memory, upload the sketch through its boot loader, write
the numbers with the Pi's delay after each, wait until the chip must have emptied its ring, and ask for the
result. The wait keeps the question from being lost in a full ring, so that the answer tells of the numbers
and not of itself.
"""

import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from math import ceil
from pathlib import Path
from threading import Lock, Semaphore
from typing import Literal

from robot_runtime.experiments.comm_test.builder import Builder
from robot_runtime.experiments.comm_test.document import CommTest
from robot_runtime.experiments.comm_test.emulated_line import EmulatedLine
from robot_runtime.experiments.comm_test.framings import ANSWER_BYTES, STREAM_FRAMINGS, find_answer
from robot_runtime.experiments.comm_test.line import BITS_PER_BYTE, Cancellation, CommTestLine, check
from robot_runtime.experiments.comm_test.link_end import estimate_link_seconds, run_link_cell
from robot_runtime.experiments.comm_test.results import RING_BYTES, CellResult, Counts, GridCell
from robot_runtime.experiments.comm_test.upload import upload_paused
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess

Phase = Literal["compile", "upload", "run"]
Tell = Callable[[int, Phase], None]
BOOTLOADER = "firmware/optiboot.hex"
"""Path below the build folder."""
UPLOADS_AT_ONCE = 2
"""For every cell that is computed; an upload waits about 1 s for avrdude, a cell computes 1 to 10 s."""
LOOP_TIME = 0.003
"""s that a message costs the sketch beyond its delay and the line; `delay` is up to 1 ms late."""
PATIENCE = 0.05
"""s beyond what an answer takes on the line."""
QUESTIONS = 3
LOOK = 0.1
"""s of real time between two looks whether a cell is done."""


class Runner:
    """Runner of tests on `program`, the emulated board in the folder of all that is built, with sketches that
    `builder` makes, until `stop` is set.

    `computing` cells are computed at the same time, each on a board of its own; others upload meanwhile,
    which is mostly waiting.
    """

    def __init__(
        self, builder: Builder, program: Path, computing: int, stop: Cancellation | None = None
    ) -> None:
        self._builder = builder
        self._program = program
        self._options = ("--bootloader", str(program.parent / BOOTLOADER), "--paused", "--with-parent")
        self._at_once = computing + UPLOADS_AT_ONCE * computing
        self._stop = stop or Cancellation()
        self._building = Lock()
        self._computing = Semaphore(computing)

    def run(self, test: CommTest, tell: Tell = lambda _number, _phase: None) -> Iterator[CellResult]:
        """Yield the cells of the grid, in its order; `tell` is called by several threads.

        Closing the iterator cancels. Raise SketchBuildError, BoardError, UploadError, PortError, and
        StoppedError.
        """

        def run_one(number: int, cell: GridCell) -> CellResult:
            return self._run_cell(test, cell, lambda phase: tell(number, phase))

        pool = ThreadPoolExecutor(self._at_once, "cell")
        try:
            cells = [pool.submit(run_one, number, cell) for number, cell in enumerate(test.cells)]
            for cell in cells:
                # The kernel may give a signal to any thread; Python's handler runs in the main one, which
                # nothing wakes if it waits without end.
                while not cell.done():
                    wait([cell], LOOK)
                yield cell.result()
        finally:
            pool.shutdown(cancel_futures=True)

    def _run_cell(self, test: CommTest, cell: GridCell, tell: Callable[[Phase], None]) -> CellResult:
        with self._building:
            check(self._stop)
            tell("compile")
            product = self._builder.build(test, cell.baud, cell.arduino_delay)
        with (
            tempfile.TemporaryDirectory(prefix="mucat-") as folder,
            EmulatorProcess(
                self._program, None, Path(folder) / "tty", Path(folder) / "socket", *self._options
            ) as process,
            process.connect() as board,
        ):
            tell("upload")
            upload_paused(product.hex, process.tty, board, self._stop)
            with self._computing, EmulatedLine(board, process.tty, cell.baud, self._stop) as line:
                tell("run")
                return run_cell(test, cell, line)


def run_cell(test: CommTest, cell: GridCell, line: CommTestLine) -> CellResult:
    """Run one cell on a board that has just been started with its sketch. Raise BoardError and PortError."""
    if test.framing not in STREAM_FRAMINGS:
        return run_link_cell(test, cell, line)
    framing = STREAM_FRAMINGS[test.framing]
    messages = [framing.message(number) for number in range(test.from_val, test.to_val)]
    line.wait(line.start_time)
    line.inject_faults(test.faults)
    for message in messages if test.direction != "to_host" else messages[:1]:
        line.write(message)
        line.wait(cell.pi_delay)
    sent = line.written
    _wait_for_board(test, cell, line, len(messages[0]))
    board, answer_at = _request_result(framing.request, cell, line)
    stream = line.heard[:answer_at]
    sends = test.direction != "to_board"
    host = framing.count(stream, test.from_val, test.to_val) if sends else Counts()
    return CellResult(
        cell=cell,
        direction=test.direction,
        expected=test.expected,
        board=board,
        host=host,
        lost_to_board=sent - board.bytes_read if board else 0,
        lost_to_host=sum(map(len, messages)) - len(stream) if sends else 0,
        line=line.errors(),
        seconds=line.now,
    )


def estimate_seconds(test: CommTest, cell: GridCell) -> float:
    """Return the estimated duration of a cell in emulated time, s."""
    if test.framing not in STREAM_FRAMINGS:
        return estimate_link_seconds(test, cell)
    message_bytes = len(STREAM_FRAMINGS[test.framing].message(test.from_val))
    airtime = test.expected * message_bytes * BITS_PER_BYTE / cell.baud
    emptying = (RING_BYTES / message_bytes + 1) * (cell.arduino_delay + LOOP_TIME)
    sending = 0.0 if test.direction == "to_host" else test.expected * cell.pi_delay
    answering = 0.0 if test.direction == "to_board" else test.expected * cell.arduino_delay
    return max(airtime, sending, answering) + emptying


def _wait_for_board(test: CommTest, cell: GridCell, line: CommTestLine, message_bytes: int) -> None:
    line.drain()
    each = cell.arduino_delay + LOOP_TIME
    to_read = ceil(RING_BYTES / message_bytes)
    to_send = 0
    if test.direction != "to_board":
        each += message_bytes * line.byte_time
        to_send = test.expected - len(line.heard) // message_bytes
    line.wait((max(to_read, to_send) + 1) * each)


def _request_result(request: bytes, cell: GridCell, line: CommTestLine) -> tuple[Counts | None, int]:
    # The line has no faults from here on, and earlier bytes, such as an answer to damaged ones, are ignored.
    line.clear_faults()
    before = len(line.heard)
    for _ in range(QUESTIONS):
        line.write(request)
        line.wait(line.busy + cell.arduino_delay + ANSWER_BYTES * line.byte_time + PATIENCE)
        if answer := find_answer(line.heard[before:]):
            counts, at = answer
            return counts, before + at
    return None, len(line.heard)
