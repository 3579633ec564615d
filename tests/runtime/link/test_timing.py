"""Rates of telemetry by baud; tests/board/test_speeds.py compares them with the firmware."""

import pytest

from robot_runtime.contract.packets import Depth, Imu, Status
from robot_runtime.link.timing import periods, stale_after


def test_a_fast_line_carries_the_full_rate() -> None:
    assert periods(250_000) == periods(115_200)
    assert (periods(250_000)[Imu], periods(250_000)[Depth], periods(250_000)[Status]) == (0.01, 0.02, 0.1)


@pytest.mark.parametrize(
    ("baud", "depth", "status"), [(57_600, 0.04, 0.2), (9600, 0.07, 0.21), (1200, 0.52, 1.56)]
)
def test_a_slow_line_carries_the_sensors_used_for_control(baud: int, depth: float, status: float) -> None:
    assert periods(baud)[Depth] == pytest.approx(depth)
    assert periods(baud)[Status] == pytest.approx(status)


def test_a_value_is_stale_after_three_missed_packets_and_not_before_the_usual_limit() -> None:
    assert stale_after(0.5, Depth, 250_000) == 0.5
    assert stale_after(0.5, Depth, 1200) == pytest.approx(1.56)
