"""Cells on the emulated board: arrivals, losses and their causes."""

from pathlib import Path

import pytest

from robot_runtime.experiments.comm_test.builder import Builder
from robot_runtime.experiments.comm_test.emulated_line import EmulatedLine
from robot_runtime.experiments.comm_test.results import Counts, GridCell
from robot_runtime.experiments.comm_test.runner import Runner, run_cell
from robot_runtime.simulation.boards.emulator_process import EmulatorProcess
from tests.runtime.experiments.comm_test.conftest import Run, make_test

RING = 63


@pytest.mark.parametrize("baud", [1200, 57600, 115200, 500000])
def test_plain_numbers_all_arrive_at_a_sketch_that_keeps_up(run: Run, baud: int) -> None:
    (result,) = run(framing="plain", baud_rate=(baud,))
    assert result.board == Counts(right=100, bytes_read=200)
    assert (result.rate, result.causes, result.explanation) == (1.0, (), "every number arrived")
    assert result.seconds > 200 * 10 / baud


@pytest.mark.parametrize("direction", ["to_board", "to_host", "both"])
def test_an_end_mark_within_a_thesis_packet_loses_two_numbers(run: Run, direction: str) -> None:
    (result,) = run(direction=direction, baud_rate=(9600,))
    ends = 2 if direction == "both" else 1
    assert result.counts == Counts(98 * ends, 0, 0, 2 * ends, 0, 900 * ends)
    assert (result.rate, result.causes) == (0.98, ("framing error",))
    assert "end mark" in result.explanation


def test_a_slow_sketch_receives_only_the_numbers_in_its_ring(run: Run) -> None:
    plain, thesis = (run(framing=name, arduinodelay=(0.1,))[0] for name in ("plain", "thesis"))
    assert plain.board is not None
    assert plain.board.bytes_read in (RING + 1, RING + 2)
    assert plain.lost_to_board == 200 - plain.board.bytes_read
    assert plain.rate == plain.board.bytes_read // 2 / 100
    assert plain.causes[0] == "ring overrun"
    assert f"{plain.lost_to_board} bytes were lost" in plain.explanation
    assert thesis.rate == (RING + 9) // 9 / 100


def test_numbers_waiting_in_the_host_s_port_are_not_lost(run: Run) -> None:
    (result,) = run(from_val=1000, to_val=2000, expected=1000, baud_rate=(500000,))
    assert result.board is not None
    assert result.board.bytes_read == 9000
    ends_early = sum(0x0A in (n >> 8, n & 255, 1 ^ n >> 8 ^ n & 255) for n in range(1000, 2000))
    assert result.board.right == 1000 - ends_early


def test_the_delays_are_seconds_of_emulated_time(run: Run) -> None:
    numbers = {"from_val": 1, "to_val": 9, "expected": 8, "framing": "plain"}
    quick, pi, arduino = run(delay=(0.0, 0.5), **numbers) + run(
        arduinodelay=(0.5,), direction="to_host", **numbers
    )
    assert pi.seconds - quick.seconds == pytest.approx(8 * 0.5, abs=0.01)
    assert arduino.seconds - quick.seconds > 8 * 0.5
    assert (pi.rate, arduino.rate) == (1.0, 1.0)


def test_both_directions_at_once(run: Run) -> None:
    (result,) = run(framing="plain", direction="both")
    assert result.board == result.host == Counts(right=100, bytes_read=200)
    assert result.rate == 1.0


def test_the_same_test_gives_the_same_results_however_many_cells_run_at_once(
    builder: Builder, program: Path
) -> None:
    test = make_test(delay=(0.0, 0.05), arduinodelay=(0.0, 0.1), direction="both")
    alone = list(Runner(builder, program, 1).run(test))
    assert [result.cell for result in alone] == test.cells
    assert list(Runner(builder, program, 3).run(test)) == alone


def test_a_board_that_does_not_understand_is_a_lost_result(
    builder: Builder, program: Path, tmp_path: Path
) -> None:
    test, cell = make_test(baud_rate=(9600,)), GridCell(9600, 0.0, 0.0)
    product = builder.build(test, 19200, 0.0)
    with (
        EmulatorProcess(program, product.elf, tmp_path / "tty", tmp_path / "socket", "--paused") as process,
        process.connect() as board,
        EmulatedLine(board, process.tty, cell.baud) as line,
    ):
        result = run_cell(test, cell, line)
    assert (result.board, result.rate, result.causes[0]) == (None, 0.0, "lost result")
    assert "line" in result.causes


def test_closing_the_iterator_cancels_the_run(builder: Builder, program: Path) -> None:
    test = make_test(delay=tuple(number / 10 for number in range(100)))
    begun: set[int] = set()
    cells = Runner(builder, program, 1).run(test, lambda number, _: begun.add(number))
    assert next(cells).cell == test.cells[0]
    cells.close()  # type: ignore[attr-defined]
    # Those under way end. All of the hundred are 13 emulated hours, many minutes of computing.
    assert len(begun) < 50
    assert next(cells, None) is None
