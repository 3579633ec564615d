"""A short version of `make faults`."""

import pytest

from tests.board.rig import ROOT, build
from tests.proofs import faults, outages
from tests.proofs.faults import ROWS, Row
from tests.stack import Stack

SLOW = {"capsized", "not_rising", "battery_low"}
"""Half a minute each; `tests/runtime/control/test_faults_in_water.py` has them, too."""


@pytest.fixture(scope="module", autouse=True)
def _built() -> None:
    build(ROOT / "firmware/emulator")
    build(ROOT / "firmware", "robot", "hang", "full")


@pytest.mark.parametrize("row", [row for row in ROWS if row.name not in SLOW], ids=lambda row: row.name)
def test_a_fault_is_reported_and_the_fins_stop_in_time(row: Row) -> None:
    assert faults.measure(row, 2, seed=3).problems == []


@pytest.mark.stack
def test_processes_that_are_killed_or_hang_stop_the_robot_and_come_back(shared_stack: Stack) -> None:
    outcomes = outages.measure_on(shared_stack, 1, seed=3)
    assert {outcome.outage for outcome in outcomes} == set(outages.OUTAGES)
    assert [(outcome.outage.name, problem) for outcome in outcomes for problem in outcome.problems] == []
