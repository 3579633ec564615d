"""Cells over the robot's own link: under any faults every number arrives once and in order."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.experiments.comm_test.builder import Builder
from robot_runtime.experiments.comm_test.emulated_line import EmulatedLine
from robot_runtime.experiments.comm_test.link_end import GREETING_PATIENCE, estimate_link_seconds
from robot_runtime.experiments.comm_test.results import CellResult, Counts
from robot_runtime.experiments.comm_test.runner import Runner, run_cell
from robot_runtime.link.session import SILENCE
from robot_runtime.simulation.boards.emulator_process import EmulatorClient, EmulatorProcess
from tests.runtime.experiments.comm_test.conftest import Run, make_test

DIRECTIONS = ("to_board", "to_host", "both")
Harm = Callable[[EmulatorClient], None]
RunHarmed = Callable[..., CellResult]


class HarmedLine(EmulatedLine):
    """A line with a fault at a moment of emulated time, in s."""

    harm: Harm | None = None
    harm_at = 0.0

    def wait(self, seconds: float) -> None:
        super().wait(seconds)
        if self.harm and self.now >= self.harm_at:
            self.harm(self._board)
            self.harm = None


@pytest.fixture
def run_harmed(builder: Builder, program: Path, tmp_path: Path) -> RunHarmed:
    """Run one cell over the robot's link; `harm` is applied to the board at `harm_at`."""

    def run(harm: Harm, harm_at: float, baud_of_sketch: int = 115200, **changes: Any) -> CellResult:
        test = make_test(framing="robot", **changes)
        (cell,) = test.cells
        product = builder.build(test, baud_of_sketch, cell.arduino_delay)
        with (
            EmulatorProcess(
                program, product.elf, tmp_path / "tty", tmp_path / "socket", "--paused"
            ) as process,
            process.connect() as board,
            HarmedLine(board, process.tty, cell.baud) as line,
        ):
            line.harm, line.harm_at = harm, harm_at
            return run_cell(test, cell, line)

    return run


def check_all_arrived(result: CellResult) -> None:
    assert result.board is not None
    board = 0 if result.direction == "to_host" else 100
    host = 0 if result.direction == "to_board" else 100
    # The first number of `to_host` starts the board, which counts it.
    assert result.board.right == (board or 1)
    assert result.host.right == host
    assert result.counts.out_of_sequence == 0
    assert (result.rate, result.causes) == (1.0, ())
    assert result.explanation.startswith("every number arrived")


@pytest.mark.parametrize("baud", [1200, 9600, 115200, 500000])
@pytest.mark.parametrize("direction", DIRECTIONS)
def test_every_number_arrives_at_every_baud(run: Run, direction: str, baud: int) -> None:
    (result,) = run(framing="robot", direction=direction, baud_rate=(baud,))
    check_all_arrived(result)
    assert result.counts.checksum_errors == 0
    assert result.seconds < 2 * estimate_link_seconds(make_test(direction=direction), result.cell) + 5


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_slow_sketch_loses_nothing(run: Run, direction: str) -> None:
    """With the thesis's framing 8 % of these numbers arrive; here numbers without room wait at the host."""
    (result,) = run(framing="robot", direction=direction, arduinodelay=(0.1,))
    check_all_arrived(result)
    assert result.seconds == pytest.approx(10, abs=0.5)
    # While there is no room the line is quiet: two frames a second ask whether there is now.
    assert result.repeated < 50


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_bad_line_costs_time_and_no_number(run_harmed: RunHarmed, direction: str) -> None:
    def harm(board: EmulatorClient) -> None:
        board.seed_line(1)
        for way in ("to_board", "from_board"):
            board.disturb_line(way, "bit_errors", 1e-3)
            board.disturb_line(way, "drop", 5e-3)
            board.disturb_line(way, "double", 5e-3)

    result = run_harmed(harm, 0.0, direction=direction, arduinodelay=(0.02,), delay=(0.01,))
    check_all_arrived(result)
    assert result.repeated > 10
    assert result.counts.checksum_errors > 10
    assert f"retransmitted frames: {result.repeated}" in result.explanation


def test_the_same_test_gives_the_same_results_however_many_cells_run_at_once(
    builder: Builder, program: Path
) -> None:
    test = make_test(framing="robot", delay=(0.0, 0.01), arduinodelay=(0.0, 0.02), direction="both")
    alone = list(Runner(builder, program, 1).run(test))
    assert [result.rate for result in alone] == [1.0] * 4
    assert list(Runner(builder, program, 3).run(test)) == alone


def test_both_ends_wait_their_delays(run: Run) -> None:
    numbers = {"framing": "robot", "from_val": 1, "to_val": 9, "expected": 8}
    quick, pi = run(delay=(0.0, 0.5), **numbers)
    (arduino,) = run(arduinodelay=(0.5,), direction="to_host", **numbers)
    assert pi.seconds - quick.seconds == pytest.approx(8 * 0.5, abs=0.05)
    assert arduino.seconds - quick.seconds == pytest.approx(8 * 0.5, abs=0.6)


def test_a_board_that_never_answers_is_reported(run_harmed: RunHarmed) -> None:
    result = run_harmed(lambda _: None, 0.0, baud_of_sketch=250000)
    assert (result.board, result.rate, result.host) == (None, 0.0, Counts())
    assert result.causes[0] == "no link"
    assert "did not answer within 30 s" in result.explanation
    assert result.seconds == pytest.approx(GREETING_PATIENCE, abs=0.5)


@pytest.mark.parametrize("delays", [{"arduinodelay": (0.1,)}, {"delay": (0.5,)}], ids=["busy", "idle"])
def test_a_board_that_restarts_is_reported(run_harmed: RunHarmed, delays: dict[str, Any]) -> None:
    result = run_harmed(lambda board: board.reset(), 1.2, **delays)
    assert (result.board, result.causes[0]) == (None, "restart")
    assert "the chip restarted after" in result.explanation
    # At once by its HELLO, or after the silence that shows that this was lost.
    assert result.seconds < 1.2 + SILENCE + 0.5


def test_a_line_that_stays_cut_is_given_up_with_an_error(run_harmed: RunHarmed) -> None:
    result = run_harmed(lambda board: board.cut_line("to_board", True), 1.0, arduinodelay=(0.03,))
    assert (result.board, result.rate) == (None, 0.0)
    assert result.causes[0] == "out of time"


def test_a_line_that_is_cut_for_a_while_loses_nothing(run_harmed: RunHarmed) -> None:
    def harm(board: EmulatorClient) -> None:
        for way in ("to_board", "from_board"):
            board.stall_line(way, 3.0)

    check_all_arrived(run_harmed(harm, 1.0, direction="both", arduinodelay=(0.1,)))
