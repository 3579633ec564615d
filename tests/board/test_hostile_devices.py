"""The robot's firmware at full load on a board whose devices misbehave, in emulated time."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from robot_runtime.contract.packets import (
    Depth,
    DeviceFault,
    Imu,
    Navigation,
    ResetCause,
    Status,
    StatusFlag,
)
from robot_runtime.simulation.boards.emulator_process import STILL_WATER, FaultKind
from tests.board.host import EmulatedRobot, all_of, last, start
from tests.board.rig import ROOT, build

DOWN = Navigation(x=0.0, y=0.0, z=1.0, roll=0.0, pitch=0.0, yaw=0.0)
SENSORS = DeviceFault.IMU | DeviceFault.PRESSURE
BRIDGES = DeviceFault(sum(DeviceFault.BRIDGE_FRONT_RIGHT << fin for fin in range(4)))
FRONT_RIGHT, BACK_RIGHT, BACK_LEFT = (
    DeviceFault(DeviceFault.TRACKING_FRONT_RIGHT << fin) for fin in range(3)
)
TICK_US = 10_000


@pytest.fixture
def robot(built: None, tmp_path: Path) -> Iterator[EmulatedRobot]:  # noqa: ARG001 - built first
    build(ROOT / "firmware", "robot")
    with start("robot", tmp_path) as rig:
        robot = EmulatedRobot(rig)
        robot.listen(0.5)
        robot.arm()
        robot.converse(0.5, DOWN)
        yield robot


def assert_untroubled(robot: EmulatedRobot, statuses: list[Status]) -> None:
    """No tick was late, and the robot is armed throughout."""
    assert {status.missed_ticks for status in statuses} == {0}
    assert max(status.loop_worst for status in statuses) < TICK_US
    assert all(status.flags & StatusFlag.ARMED for status in statuses)
    assert robot.board.stats()["watchdog_resets"] == 0


@pytest.mark.parametrize(
    ("device", "kind", "faults"),
    [
        ("imu", "absent", DeviceFault.IMU),
        ("pressure", "absent", DeviceFault.PRESSURE),
        ("encoder0", "absent", DeviceFault.ENCODER_FRONT_RIGHT),
        ("encoder1", "weak", DeviceFault.MAGNET),
        ("bridge2", "absent", DeviceFault.BRIDGE_BACK_LEFT),
        ("i2c", "refused", SENSORS | BRIDGES),
        ("i2c", "stretched", SENSORS | BRIDGES),
        ("i2c", "contested", SENSORS | BRIDGES),
    ],
)
def test_no_device_delays_a_tick_and_each_is_reported_and_found_again(
    robot: EmulatedRobot, device: str, kind: FaultKind, faults: DeviceFault
) -> None:
    robot.board.fault(device, kind)
    statuses = all_of(robot.converse(1.5, DOWN), Status)
    assert statuses[-1].faults == faults
    robot.board.fault(device, "none")
    statuses += all_of(robot.converse(1.0, DOWN), Status)
    assert statuses[-1].faults == 0
    assert_untroubled(robot, statuses)


@pytest.mark.parametrize(
    ("mistake", "faults"),
    [
        ("gyro-offset:20,-20,20", 0),
        ("encoder-noise:2", 0),
        ("backlash:0.05", 0),
        ("stiction:18", 0),
        ("pack-resistance:0.5", 0),
        ("regulator-off:5", 0),
        ("regulator-off:-5", 0),
        ("imu-turned:+x-y-z", 0),
        ("motors-swapped:front-right,back-right", FRONT_RIGHT | BACK_RIGHT),
        ("encoders-swapped:front-right,back-left", FRONT_RIGHT | BACK_LEFT),
        ("missing:motor-back-left", BACK_LEFT),
        ("strap-wrong:back-left", DeviceFault.BRIDGE_BACK_LEFT),
        ("imu-strap", DeviceFault.IMU),
    ],
)
def test_a_mistake_delays_no_tick_and_stops_no_sound_fin(
    robot: EmulatedRobot, mistake: str, faults: DeviceFault
) -> None:
    robot.board.mistake(mistake)
    statuses = all_of(robot.converse(2.5, DOWN), Status)
    assert statuses[-1].faults == faults
    assert_untroubled(robot, statuses)


def test_a_brown_out_stops_the_fins_at_once_and_the_board_comes_back(robot: EmulatedRobot) -> None:
    before = last(robot.heard, Status)
    for lost, cause in ((0.0, ResetCause.EXTERNAL), (0.5, ResetCause.POWER_ON)):
        robot.board.brown_out(lost)
        assert not robot.board.fins().powered
        robot.listen(0.5)
        assert not robot.board.fins().powered
        robot.greet()
        status = robot.status()
        assert not status.flags & (StatusFlag.ARMED | StatusFlag.MOTOR_POWER)
        assert status.epoch == before.epoch + 1
        assert (status.faults, status.reset_cause) == (0, cause)
        before = status
        robot.arm()
        robot.converse(0.5, DOWN)
    assert robot.board.stats()["watchdog_resets"] == 0


@pytest.mark.parametrize("lost", [0.1, 0.2, 1.0])
def test_no_brown_out_under_water_moves_the_surface(robot: EmulatedRobot, lost: float) -> None:
    """The surface's pressure in the memory may be damaged; that in EEPROM is not."""
    robot.board.sense(STILL_WATER._replace(pressure=STILL_WATER.pressure + 1.5 * 9810))
    robot.converse(0.1, DOWN)
    for _ in range(4):
        robot.board.brown_out(lost)
        robot.listen(0.5)
        robot.greet()
        packets = robot.listen(0.5)
        assert last(packets, Depth).depth == pytest.approx(1.5, abs=0.01)
        # Only where memory lost it, it is uncertain.
        assert last(packets, Status).faults in (
            {DeviceFault.SURFACE} if lost == 1 else {0, DeviceFault.SURFACE}
        )
    robot.board.sense(STILL_WATER)
    robot.listen(0.1)
    assert last(robot.listen(0.5), Status).faults == 0
    robot.arm()


def test_a_brown_out_is_never_called_a_hang(robot: EmulatedRobot) -> None:
    """The memory that tells a hang may be damaged, while the mark that it was running survives."""
    causes = set()
    for _ in range(60):
        robot.board.brown_out(0.1)
        robot.listen(0.4)
        robot.greet()
        causes.add(last(robot.listen(0.3), Status).reset_cause)
    assert causes == {ResetCause.POWER_ON, ResetCause.EXTERNAL}


@pytest.mark.parametrize("kind", ["refused", "stretched", "contested"])
def test_fins_stop_in_time_on_a_bus_that_misbehaves(robot: EmulatedRobot, kind: FaultKind) -> None:
    """The motor power goes by a pin of its own, whatever the bus does."""
    robot.board.fault("i2c", kind)
    robot.listen(1.2)  # the host is silent
    fins = robot.board.fins()
    assert not fins.powered
    assert fins.speeds == pytest.approx((0, 0, 0, 0), abs=0.02)


def test_nine_clocks_free_a_bus_whose_data_line_is_held_low(robot: EmulatedRobot) -> None:
    for _ in range(5):
        robot.board.fault("i2c", "stuck")
        statuses = all_of(robot.converse(0.5, DOWN), Status)
        assert statuses[-1].faults == 0
        assert statuses[-1].missed_ticks == 0
        assert max(status.loop_worst for status in statuses) < TICK_US
    assert robot.board.stats()["watchdog_resets"] == 0


def test_an_imu_that_fell_asleep_is_woken_within_100_ms(robot: EmulatedRobot) -> None:
    before = last(robot.heard, Imu)
    robot.board.fault("imu", "dip")
    packets = robot.converse(0.5, DOWN)
    readings = [before, *all_of(packets, Imu)]
    gaps = [after.time - before.time for before, after in pairwise(readings)]
    assert 50_000 < max(gaps) < 100_000  # µs; the gyroscope needs 50 ms to start
    assert all(reading.force[2] for reading in readings)
    assert last(packets, Status).faults == 0


@pytest.mark.parametrize("identity", ["0x70", "0x71", "0x72", "0x98"])
def test_each_imu_measures_rightly_again_within_1_100_ms_after_a_dip(
    robot: EmulatedRobot, identity: str
) -> None:
    robot.board.mistake(f"imu-clone:{identity}")
    robot.converse(1.2, DOWN)
    robot.board.fault("imu", "dip")
    robot.converse(1.1, DOWN)
    packets = robot.converse(0.5, DOWN)
    assert [reading.force[2] for reading in all_of(packets, Imu)] == pytest.approx([-9.81] * 50, abs=0.1)
    assert last(packets, Status).faults == 0


def test_a_tripped_bridge_is_reported_and_cleared(robot: EmulatedRobot) -> None:
    robot.board.fault("bridge1", "tripped")
    statuses = all_of(robot.converse(1.0, DOWN), Status)
    assert DeviceFault.BRIDGE_BACK_RIGHT in {status.faults for status in statuses}
    assert statuses[-1].faults == 0
    assert abs(robot.board.fins().speeds[1]) > 0.5
