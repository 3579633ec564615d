"""The robot's firmware at its default baud while the line is full both ways and devices misbehave."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from bench.firmware import BAUD, FloodHost
from robot_runtime.contract.packets import StatusFlag
from tests.board.host import start
from tests.board.rig import ROOT, Rig, build

TICK_US = 10_000
CAPACITY = BAUD / 10
"""Bytes a second, each way."""


@pytest.fixture
def rig(built: None, tmp_path: Path) -> Iterator[Rig]:  # noqa: ARG001 - built first
    build(ROOT / "firmware", "robot")
    with start("robot", tmp_path) as rig:
        yield rig


@pytest.mark.parametrize(
    "commands",
    [
        ["fault imu absent"],
        ["fault imu dip"],
        ["fault pressure absent"],
        ["fault encoder0 absent", "fault encoder1 weak"],
        ["fault bridge0 absent", "fault bridge1 tripped"],
        ["fault i2c stuck"],
        ["fault i2c refused"],
        ["fault i2c stretched"],
        ["fault i2c contested"],
        ["mistake motors-swapped:front-right,back-right", "mistake encoder-noise:2"],
    ],
    ids=lambda commands: " ".join(commands),
)
def test_no_device_delays_a_tick_while_the_line_is_full(rig: Rig, commands: list[str]) -> None:
    host = FloodHost(rig, BAUD)
    host.arm()
    host.flood(0.3)
    sent, heard, began, host.worst = host.sent, host.heard, host.now, 0
    for _ in range(2):  # a fault that mends itself comes again
        for command in commands:
            rig.board.command(command)
        host.flood(0.3)
    passed = host.now - began
    assert (host.sent - sent) / passed > 0.95 * CAPACITY
    # The board says all it can: telemetry, and a line of text at every tick.
    assert (host.heard - heard) / passed > 0.25 * CAPACITY
    assert host.status is not None
    assert host.status.flags & StatusFlag.ARMED
    assert host.status.missed_ticks == 0
    assert 0 < host.worst < TICK_US
    assert rig.board.stats()["watchdog_resets"] == 0
