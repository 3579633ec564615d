"""Faults on the line of a cell: their times, their effects, and their repeatability."""

from itertools import islice

import pytest

from robot_runtime.experiments.comm_test.faults import Faults
from robot_runtime.experiments.comm_test.results import Counts
from tests.runtime.experiments.comm_test.conftest import Run


def test_stalls_and_cuts_come_in_order_from_the_beginning_of_the_traffic_on() -> None:
    faults = Faults(stall=(2.0, 0.5), cut=(3.0, 1.0))
    assert list(islice(faults.timed(10.0), 7)) == [
        (12.0, "stall", 0.5),
        (13.0, "cut", 1.0),
        (14.0, "mend", 1.0),
        (14.0, "stall", 0.5),
        (16.0, "cut", 1.0),
        (16.0, "stall", 0.5),
        (17.0, "mend", 1.0),
    ]
    assert list(Faults(bit_errors=0.1).timed(0.0)) == []


def test_noise_is_reported_and_repeatable(run: Run) -> None:
    noise = Faults(seed=3, bit_errors=1e-3, drop=5e-3, double=5e-3, insert=5e-3, burst=(1e-3, 20))
    changes = {"framing": "plain", "direction": "both", "faults": noise, "delay": (0.0, 0.01)}
    first, second = run(**changes), run(**changes)
    assert first == second
    for result in first:
        faults = result.line.faults
        assert min(faults.bit_errors, faults.drops, faults.doubles, faults.inserts, faults.bursts) > 0
        assert result.rate < 1
        assert f"injected faults: {faults.bit_errors} wrong bits" in result.explanation
        assert result.values["bytes_lost"] >= 0
    (other,) = run(**changes | {"faults": Faults(seed=4, bit_errors=1e-3), "delay": (0.0,)})
    assert other.line.faults != first[0].line.faults


def test_a_stall_loses_nothing_and_takes_its_time(run: Run) -> None:
    changes = {"framing": "plain", "baud_rate": (9600,), "direction": "both"}
    (clean,) = run(**changes)
    (stalled,) = run(**changes, faults=Faults(stall=(0.1, 0.05)))
    assert stalled.line.faults.stalls > 2
    assert (stalled.board, stalled.host) == (clean.board, clean.host) == (Counts(100, bytes_read=200),) * 2
    assert stalled.seconds > clean.seconds + 0.05
    assert "stalls" in stalled.explanation


def test_a_cut_line_loses_what_is_on_it(run: Run) -> None:
    # 100 numbers of two bytes, every 20 ms one; the line is cut for 0.5 s in every second.
    (result,) = run(framing="plain", delay=(0.02,), faults=Faults(cut=(1.0, 0.5)))
    assert result.line.faults.cuts == pytest.approx(50, abs=4)
    assert result.lost_to_board >= 46
    assert result.rate == pytest.approx(0.75, abs=0.02)
    assert f"{result.line.faults.cuts} bytes lost while the line was cut" in result.explanation


def test_more_bytes_than_the_port_buffers_pass_a_line_that_inserts_bytes(run: Run) -> None:
    numbers = {"from_val": 100, "to_val": 2100, "expected": 2000}
    (result,) = run(**numbers, framing="thesis", faults=Faults(double=0.1, insert=0.1))
    assert result.board is not None
    assert result.board.bytes_read > 18000 * 1.1


def test_the_robots_own_link_loses_nothing_on_a_bad_line(run: Run) -> None:
    faults = Faults(seed=1, bit_errors=1e-3, drop=1e-3, stall=(0.5, 0.1), cut=(0.7, 0.1))
    changes = {"framing": "robot", "direction": "both", "to_val": 501, "expected": 500}
    (result,) = run(**changes, faults=faults)
    assert (result.rate, result.causes) == (1.0, ())
    assert result.repeated > 0
    assert "injected faults: " in result.explanation
    assert run(**changes, faults=faults) == [result]
