"""The host's end of a cell over the robot's own link, driven by the line's clock.

`LinkSession` and `Channel` are those of the robot. Numbers, the question and the answer are reliable packets:
they arrive exactly once and in order, and what the other end has no room for is sent again until it has. So
nothing has to be timed: a cell ends when the answer is there. It is asked for behind the last number; where
the board sends numbers too, once all of those are there.
"""

from robot_runtime.contract.packets import Packet, RequestResult, TestMsg, TestResult
from robot_runtime.experiments.comm_test.document import CommTest
from robot_runtime.experiments.comm_test.framings import Sequence
from robot_runtime.experiments.comm_test.line import BITS_PER_BYTE, CommTestLine
from robot_runtime.experiments.comm_test.results import CellResult, Counts, Finding, GridCell, LinkCellResult
from robot_runtime.link.session import LinkSession, SessionStage

HOST_EPOCH = 1
"""The board's epoch differs in every cell, so this one need not."""
REACTION_BYTES = 16
REACTION_MIN, REACTION_MAX = 0.005, 0.02
"""Limits in s of the pause between two reads while an answer is awaited."""
NUMBER_BYTES, NUMBER_BYTES_ALONE = 4, 20
"""Approximate bytes of a number on the line, in a frame with others and in a frame of its own."""
GREETING_TIME = 0.5
"""s, about."""
GREETING_PATIENCE = 30.0
"""s of test time for the first answer."""
PATIENCE = 60.0
PATIENCE_FACTOR = 5
"""A cell is given up after so many times what it should take, and PATIENCE s."""


def run_link_cell(test: CommTest, cell: GridCell, line: CommTestLine) -> CellResult:
    """Run one cell on a board that has just been started with its sketch. Raise BoardError and PortError."""
    return _LinkCell(test, cell, line).run()


def estimate_link_seconds(test: CommTest, cell: GridCell) -> float:
    """Return the estimated duration of a cell over the robot's own link, s of test time."""
    alone = cell.arduino_delay > 0 or cell.pi_delay > 0
    airtime = test.expected * (NUMBER_BYTES_ALONE if alone else NUMBER_BYTES) * BITS_PER_BYTE / cell.baud
    # The sketch takes or sends every number, so every delay counts.
    delays = [cell.arduino_delay] if test.direction == "to_host" else [cell.arduino_delay, cell.pi_delay]
    return GREETING_TIME + max(airtime, *(test.expected * delay for delay in delays))


class _LinkCell:
    def __init__(self, test: CommTest, cell: GridCell, line: CommTestLine) -> None:
        self._test, self._cell, self._line = test, cell, line
        self._patience = PATIENCE_FACTOR * estimate_link_seconds(test, cell) + PATIENCE
        self._session = LinkSession(HOST_EPOCH, cell.baud)
        self._reaction = min(max(REACTION_BYTES * line.byte_time, REACTION_MIN), REACTION_MAX)
        sends = test.direction != "to_host"
        self._numbers = iter(range(test.from_val, test.to_val if sends else test.from_val + 1))
        self._next: int | None = next(self._numbers)
        self._next_at = 0.0
        self._awaited = test.expected if test.direction != "to_board" else 0
        self._sequence = Sequence(test.from_val, test.to_val)
        self._boot: int | None = None
        self._requested = False
        self._answer: TestResult | None = None
        self._read = 0

    def run(self) -> CellResult:
        self._line.wait(self._line.start_time)
        self._line.inject_faults(self._test.faults)
        while self._answer is None and not self._given_up():
            self._send_due()
            self._line.wait(self._pause())
            self._receive()
        return self._result()

    @property
    def _established(self) -> bool:
        return self._session.stage is SessionStage.ESTABLISHED

    @property
    def _all_received(self) -> bool:
        return self._sequence.right + self._sequence.out_of_sequence >= self._awaited

    def _given_up(self) -> bool:
        if self._session.board is None:
            return self._line.now > GREETING_PATIENCE
        refused = self._session.stage is SessionStage.REFUSED
        return refused or self._restarted or self._line.now > self._patience

    @property
    def _restarted(self) -> bool:
        board = self._session.board
        return board is not None and self._boot not in (None, board.epoch)

    def _send_due(self) -> None:
        now = self._line.now
        packets = self._due_packets(now) if self._established else []
        data = self._session.send(packets, now) if packets else self._session.poll(now)
        if data:
            self._line.write(data)

    def _due_packets(self, now: float) -> list[Packet]:
        packets: list[Packet] = []
        while self._next is not None and now >= self._next_at:
            packets.append(TestMsg(number=self._next))
            self._next = next(self._numbers, None)
            self._next_at = now + self._cell.pi_delay
        if self._next is None and now >= self._next_at and self._all_received and not self._requested:
            self._requested = True
            packets.append(RequestResult())
        return packets

    def _pause(self) -> float:
        """Return the time (s) until the next work; while an answer is awaited, at most a reaction's time."""
        now = self._line.now
        due = self._session.due()
        if self._established and not self._requested:
            due = min(due, self._next_at) if self._next_at > now else due
        awaits = self._session.urgent or self._requested or not self._all_received or not self._established
        pause = due - now
        return max(min(pause, self._reaction) if awaits else pause, self._line.byte_time)

    def _receive(self) -> None:
        heard = self._line.heard
        data, self._read = heard[self._read :], len(heard)
        for message in self._session.receive(data, self._line.now):
            if message.type == TestMsg.type:
                self._sequence.take(TestMsg.from_bytes(message.payload).number)
            elif message.type == TestResult.type:
                self._answer = TestResult.from_bytes(message.payload)
        if self._boot is None and self._established and self._session.board:
            self._boot = self._session.board.epoch

    def _result(self) -> CellResult:
        statistics, answer = self._session.statistics(), self._answer
        board = None
        if answer is not None:
            board = Counts(
                right=answer.right,
                out_of_sequence=answer.out_of_sequence,
                checksum_errors=answer.frames_invalid,
                bytes_read=self._line.written - answer.bytes_lost,
            )
        host = Counts()
        if self._awaited:
            host = Counts(
                right=self._sequence.right,
                out_of_sequence=self._sequence.out_of_sequence,
                checksum_errors=statistics.frames_invalid,
                bytes_read=statistics.bytes_received,
            )
        return LinkCellResult(
            cell=self._cell,
            direction=self._test.direction,
            expected=self._test.expected,
            board=board,
            host=host,
            lost_to_board=answer.bytes_lost if answer else 0,
            lost_to_host=0,
            line=self._line.errors(),
            seconds=self._line.now,
            repeated=statistics.frames_repeated + (answer.frames_repeated if answer else 0),
            failures=self._failures(),
        )

    def _failures(self) -> tuple[Finding, ...]:
        if self._session.board is None:
            text = f"the chip did not answer within {GREETING_PATIENCE:g} s"
            return (("no link", f"{text}: it does not run the sketch, or runs it at another baud"),)
        if self._session.stage is SessionStage.REFUSED:
            return (("other definitions", "the sketch was compiled with other packet definitions"),)
        if self._restarted:
            lost = self._session.counters.messages_discarded
            text = f"the chip restarted after {self._line.now:.1f} s; {lost} messages to it were lost"
            return (("restart", text),)
        if self._answer is None:
            return (("out of time", f"no result after {self._line.now:.0f} s of test time"),)
        return ()
