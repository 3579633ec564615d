"""Runs a test's cells on the emulated board, in emulated time; the same test gives the same bytes.

A cell: compile, start the board with the sketch, write the numbers with the Pi's delay after each, wait until
the chip must have emptied its ring, and ask for the result. The wait keeps the question from being lost in a
full ring, so that the answer tells of the numbers and not of itself.
"""

import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from math import ceil
from pathlib import Path
from threading import Lock

from robot_runtime.comm_test.builder import Builder
from robot_runtime.comm_test.document import CommTest
from robot_runtime.comm_test.emulated_line import BITS_PER_BYTE, START_TIME, EmulatedLine
from robot_runtime.comm_test.framings import ANSWER_BYTES, STREAM_FRAMINGS, find_answer
from robot_runtime.comm_test.link_end import estimate_link_seconds, run_link_cell
from robot_runtime.comm_test.results import RING_BYTES, Cell, CellResult, Counts

LOOP_TIME = 0.003
"""s that a message costs the sketch beyond its delay and the line; `delay` is up to 1 ms late."""
PATIENCE = 0.05
"""s beyond what an answer takes on the line."""
QUESTIONS = 3


class Runner:
    """Runs tests on `program`, the emulated board, with sketches that `builder` makes.

    `at_once` cells run at the same time, each on a board of its own.
    """

    def __init__(self, builder: Builder, program: Path, at_once: int) -> None:
        self._builder = builder
        self._program = program
        self._at_once = at_once
        self._building = Lock()

    def run(self, test: CommTest) -> Iterator[CellResult]:
        """The cells of the grid, in its order; whoever stops asking has cancelled.

        Raises BuildError, BoardError and PortError.
        """
        pool = ThreadPoolExecutor(self._at_once, "cell")
        try:
            cells = [pool.submit(self._run_cell, test, cell) for cell in test.cells]
            for cell in cells:
                yield cell.result()
        finally:
            pool.shutdown(cancel_futures=True)

    def _run_cell(self, test: CommTest, cell: Cell) -> CellResult:
        with self._building:
            product = self._builder.build(test, cell.baud, cell.arduino_delay)
        with (
            tempfile.TemporaryDirectory(prefix="mucat-") as folder,
            EmulatedLine(self._program, product.elf, Path(folder), cell.baud) as line,
        ):
            return run_cell(test, cell, line)


def run_cell(test: CommTest, cell: Cell, line: EmulatedLine) -> CellResult:
    """One cell on a board that has just been started with its sketch. Raises BoardError and PortError."""
    if test.framing not in STREAM_FRAMINGS:
        return run_link_cell(test, cell, line)
    framing = STREAM_FRAMINGS[test.framing]
    messages = [framing.message(number) for number in range(test.from_val, test.to_val)]
    line.wait(START_TIME)
    for message in messages if test.direction != "to_host" else messages[:1]:
        line.write(message)
        line.wait(cell.pi_delay)
    sent = line.written
    _let_the_board_finish(test, cell, line, len(messages[0]))
    board, answer_at = _ask(framing.request, cell, line)
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


def estimate_seconds(test: CommTest, cell: Cell) -> float:
    """About how long a cell takes in emulated time, s."""
    if test.framing not in STREAM_FRAMINGS:
        return estimate_link_seconds(test, cell)
    message_bytes = len(STREAM_FRAMINGS[test.framing].message(test.from_val))
    airtime = test.expected * message_bytes * BITS_PER_BYTE / cell.baud
    emptying = (RING_BYTES / message_bytes + 1) * (cell.arduino_delay + LOOP_TIME)
    sending = 0.0 if test.direction == "to_host" else test.expected * cell.pi_delay
    answering = 0.0 if test.direction == "to_board" else test.expected * cell.arduino_delay
    return max(airtime, sending, answering) + emptying


def _let_the_board_finish(test: CommTest, cell: Cell, line: EmulatedLine, message_bytes: int) -> None:
    line.wait(line.busy)
    each = cell.arduino_delay + LOOP_TIME
    to_read = ceil(RING_BYTES / message_bytes)
    to_send = 0
    if test.direction != "to_board":
        each += message_bytes * line.byte_time
        to_send = test.expected - len(line.heard) // message_bytes
    line.wait((max(to_read, to_send) + 1) * each)


def _ask(request: bytes, cell: Cell, line: EmulatedLine) -> tuple[Counts | None, int]:
    for _ in range(QUESTIONS):
        line.write(request)
        line.wait(line.busy + cell.arduino_delay + ANSWER_BYTES * line.byte_time + PATIENCE)
        found = find_answer(line.heard)
        if found:
            return found
    return None, len(line.heard)
