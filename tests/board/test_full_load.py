"""The robot's firmware at its default baud while the line is full both ways and devices misbehave."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from bench.firmware import BAUD, FloodHost
from robot_runtime.contract.packets import DeviceFault, StatusFlag
from tests.board.host import start
from tests.board.rig import ROOT, BoardRig, build

TICK_US = 10_000
CAPACITY = BAUD / 10
"""Bytes a second, each way."""
REST, DISARMED = 0.5, 1.2
"""s after the last command, in which the fins rest, and the motors have no power."""
AT_REST = 0.02 + 0.05
"""rad that a fin at rest may move: as without faults, and through the backlash of its gear."""
BUS = DeviceFault.IMU | DeviceFault.PRESSURE
BUS |= DeviceFault(sum(DeviceFault.BRIDGE_FRONT_RIGHT << fin for fin in range(4)))


@pytest.fixture
def rig(built: None, tmp_path: Path) -> Iterator[BoardRig]:  # noqa: ARG001 - built first
    build(ROOT / "firmware", "robot")
    with start("robot", tmp_path) as rig:
        yield rig


@pytest.mark.parametrize(
    ("commands", "faults", "bus"),
    [
        (["fault imu absent"], DeviceFault.IMU, True),
        (["fault imu dip"], DeviceFault.IMU, True),
        (["fault pressure absent"], DeviceFault.PRESSURE, True),
        (
            ["fault encoder0 absent", "fault encoder1 weak"],
            DeviceFault.ENCODER_FRONT_RIGHT | DeviceFault.MAGNET,
            True,
        ),
        (
            ["fault bridge2 absent", "fault bridge1 tripped"],
            DeviceFault.BRIDGE_BACK_LEFT | DeviceFault.BRIDGE_BACK_RIGHT,
            False,
        ),
        (["fault i2c stuck"], 0, True),
        (["fault i2c refused"], BUS, False),
        (["fault i2c stretched"], BUS, False),
        (["fault i2c contested"], BUS, False),
        (
            ["mistake motors-swapped:front-right,back-right", "mistake encoder-noise:2"],
            DeviceFault.TRACKING_FRONT_RIGHT | DeviceFault.TRACKING_BACK_RIGHT,
            True,
        ),
        (
            ["mistake gyro-offset:20,-20,20", "mistake backlash:0.05", "mistake pack-resistance:0.5"],
            0,
            True,
        ),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_no_device_delays_a_tick_while_the_line_is_full(
    rig: BoardRig, commands: list[str], faults: DeviceFault, bus: bool
) -> None:
    host = FloodHost(rig, BAUD)
    host.arm()
    host.flood(0.3)
    sent, heard, began = host.sent, host.heard, host.now
    host.worst = host.faults = 0
    for _ in range(3):  # a fault that mends itself comes again, at another phase of the status
        for command in commands:
            rig.board.command(command)
        host.flood(0.33)
    passed = host.now - began
    assert (host.sent - sent) / passed > 0.95 * CAPACITY
    # The board says all it can: telemetry, and at every tick an event or its calibration.
    assert (host.heard - heard) / passed > 0.25 * CAPACITY
    assert host.status is not None
    assert host.status.flags & StatusFlag.ARMED
    assert host.status.missed_ticks == 0
    assert 0 < host.worst < TICK_US
    assert host.faults == faults
    # Now the host falls silent. A bridge that hears nothing stops when the robot is disarmed: by its power.
    rig.board.run(REST if bus else DISARMED)
    assert rig.board.fins().powered == bus
    assert movement(rig, 0.4) < AT_REST
    rig.board.run(DISARMED - REST)
    assert not rig.board.fins().powered
    assert rig.board.stats()["watchdog_resets"] == 0


def movement(rig: BoardRig, seconds: float) -> float:
    """rad between the ends of the fin's way that moves farthest."""
    angles: list[tuple[float, ...]] = []
    for _ in range(round(seconds / 0.01)):
        rig.board.run(0.01)
        angles.append(rig.board.fins().angles)
    return max(max(angle[fin] for angle in angles) - min(angle[fin] for angle in angles) for fin in range(4))
