"""The firmware for hardware in the loop: no device answers, and a host sends the sensors' values."""

from collections.abc import Iterator
from math import pi
from pathlib import Path

import pytest

from robot_runtime.contract.packets import (
    Beacon,
    Depth,
    DeviceFault,
    Imu,
    Motor,
    Navigation,
    Sense,
    StatusFlag,
)
from tests.board.host import TICK, EmulatedRobot, all_of, last, start
from tests.board.rig import ROOT, build

FORWARD = Navigation(x=1.0, y=0.0, z=0.0, roll=0.0, pitch=0.0, yaw=0.0)
SURFACE = 101_325
PASCAL_PER_METRE = 9810
DEVICES = ("imu", "pressure", *(f"encoder{fin}" for fin in range(4)), *(f"bridge{fin}" for fin in range(4)))


def word(depth: float) -> Sense:
    return Sense(
        pressure=SURFACE + round(depth * PASCAL_PER_METRE),
        temperature=12.5,
        rate=(0.1, -0.2, 0.3),
        force=(0.0, 0.0, -9.81),
        right=1,
        left=0,
        battery=7.9,
    )


@pytest.fixture
def robot(built: None, tmp_path: Path) -> Iterator[EmulatedRobot]:  # noqa: ARG001 - built first
    build(ROOT / "firmware", "robot", "HIL=1")
    with start("hil/robot", tmp_path) as rig:
        for device in DEVICES:
            rig.board.fault(device, "absent")
        robot = EmulatedRobot(rig)
        robot.listen(0.5)
        yield robot


def feel(
    robot: EmulatedRobot, depth: float, seconds: float, command: Navigation | None = None
) -> list[object]:
    """Send these values to the board for this time, fifty times a second."""
    heard: list[object] = []
    for _ in range(round(seconds / (2 * TICK))):
        robot.send(word(depth))
        heard += robot.converse(2 * TICK, command)
    return heard


def test_simulated_readings_come_back_as_telemetry(robot: EmulatedRobot) -> None:
    robot.greet()
    feel(robot, 0.0, 1.0)
    feel(robot, 0.75, 0.2)
    packets = robot.heard
    assert last(packets, Depth).depth == pytest.approx(0.75, abs=0.001)
    assert last(packets, Depth).temperature == pytest.approx(12.5)
    assert last(packets, Imu).rate == pytest.approx((0.1, -0.2, 0.3), abs=3e-4)
    assert (last(packets, Beacon).right, last(packets, Beacon).left) == (1, 0)
    status = robot.status()
    assert status.flags & StatusFlag.HIL
    assert status.battery == pytest.approx(7.9, abs=0.02)


def test_it_flaps_without_any_fin(robot: EmulatedRobot) -> None:
    feel(robot, 0.0, 0.5)
    robot.arm()
    feel(robot, 0.3, 2.0, FORWARD)
    swings = all_of(robot.heard, Motor)[-60:]
    front = [packet.angle[0] for packet in swings]
    assert max(front) - min(front) > 1.2
    assert (
        max(abs(a - b) for packet in swings for a, b in zip(packet.angle, packet.wanted, strict=True))
        < pi / 4
    )
    assert robot.status().stack_free > 50


def test_a_silent_simulator_is_a_fault_of_its_sensors(robot: EmulatedRobot) -> None:
    robot.greet()
    feel(robot, 0.0, 0.5)
    assert robot.status().faults == 0
    robot.converse(0.3)
    assert robot.status().faults == DeviceFault.IMU | DeviceFault.PRESSURE
    feel(robot, 0.0, 0.1)
    robot.send(word(0.0))
    assert robot.status().faults == 0
