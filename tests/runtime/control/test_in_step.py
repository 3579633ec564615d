"""The robot that hears its board once a control tick, in simulated time."""

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise

import pytest

from robot_runtime.contract.documents import Control
from robot_runtime.contract.topics import CONTROL, DEPTH, IMU
from tests.runtime.control.flight import Flight


@pytest.fixture(scope="module")
def flight() -> Iterator[Flight]:
    with Flight(in_step=True) as flight:
        flight.arm()
        flight.run(1.0)
        yield flight


def test_each_tick_acts_on_a_fresh_depth_and_loses_none(flight: Flight) -> None:
    ticks: list[tuple[float, float]] = []
    counts: Counter[str] = Counter()
    bus = flight.robot.bus
    bus.on_row(CONTROL, lambda time, record: ticks.append((time, Control.from_bytes(record).latency)))
    bus.on_row(IMU, lambda *_: counts.update(["imu"]))
    bus.on_row(DEPTH, lambda *_: counts.update(["depth"]))
    before = len(flight.sent)
    flight.run(20.0)
    assert flight.supervisor.mode == "automatic"
    assert max(age for _, age in ticks) < 0.015
    assert max(abs(b - a - 0.1) for (a, _), (b, _) in pairwise(ticks)) < 0.006
    assert abs(len(ticks) - 200) <= 1
    assert len(flight.sent) - before == len(ticks)
    assert abs(counts["imu"] - 2000) <= 10
    assert abs(counts["depth"] - 1000) <= 5
