"""The robot's firmware on the emulated board swims in the simulated water with working or faulty sensors."""

import math
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from statistics import fmean

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.packets import Beacon, Depth, DeviceFault, Imu, Motor, Navigation
from robot_runtime.simulation.boards.emulator_process import STILL_WATER, BoardError, EmulatorClient
from robot_runtime.simulation.water.faults import SimulatedFault
from robot_runtime.simulation.water.parameters import SimulationParameters
from robot_runtime.simulation.water.simulator import Simulator
from robot_runtime.simulation.water_process import WaterProcess
from robot_runtime.transport.zenoh_transport import ZenohTransport
from tests.board.host import TICK, EmulatedRobot, all_of, last, start
from tests.board.rig import ROOT, build, wait_for
from tests.waiting import SECONDS

PERIOD = 0.005
DOWN = Navigation(x=0.0, y=0.0, z=1.0, roll=0.0, pitch=0.0, yaw=0.0)
FLAPS_TICKS = 154
"""Two flaps at 1.3 Hz."""
SENSOR_HEIGHT = 0.05
"""m from the hull's centre to the pressure sensor above it."""


@pytest.fixture
def messages() -> Iterator[ZenohTransport]:
    with (
        tempfile.TemporaryDirectory() as folder,  # short enough for the name of a Unix socket
        ZenohTransport("turtle", listen=[f"unixsock-stream/{folder}/zenoh"]) as made,
    ):
        yield made


@pytest.fixture
def water() -> Simulator:
    return Simulator(SimulationParameters(), seed=5)


@pytest.fixture
def robot(built: None, tmp_path: Path, water: Simulator) -> Iterator[EmulatedRobot]:  # noqa: ARG001 - built first
    build(ROOT / "firmware", "robot")
    with start("robot", tmp_path) as rig:
        rig.board.attach(PERIOD, lambda fins: water.advance(PERIOD, fins))
        made = EmulatedRobot(rig)
        made.listen(1.0)
        yield made


def test_it_dives_and_measures_its_depth(robot: EmulatedRobot, water: Simulator) -> None:
    robot.arm()
    robot.converse(4.0, DOWN)
    shown = [packet.depth for packet in all_of(robot.converse(0.5, DOWN), Depth)]
    true = water.truth().position[2] - SENSOR_HEIGHT
    assert true > 0.3
    # 0.5 s at 0.18 m/s, and noise of 4 mm on the surface's pressure and on each reading.
    assert fmean(shown) == pytest.approx(true - 0.045, abs=0.03)
    assert len(set(shown)) > 5


def test_a_stuck_pressure_sensor_shows_the_same_depth_while_it_dives(
    robot: EmulatedRobot, water: Simulator
) -> None:
    robot.arm()
    robot.converse(1.0, DOWN)
    water.set_fault("pressure", SimulatedFault(kind="stuck"))
    robot.converse(0.2, DOWN)
    depths = [packet.depth for packet in all_of(robot.converse(2.0, DOWN), Depth)]
    assert max(depths) - min(depths) <= 0.001
    assert water.truth().position[2] > 0.2


def test_an_encoder_that_drifts_turns_its_fin_away(robot: EmulatedRobot, water: Simulator) -> None:
    robot.arm()
    robot.converse(2.0, DOWN)
    water.set_fault("encoder1", SimulatedFault(kind="drift", speed=0.2))
    robot.converse(2.0, DOWN)
    packets, angles = [], []
    for _ in range(FLAPS_TICKS):
        packets += robot.converse(TICK, DOWN)
        angles.append(robot.board.fins().angles)
    shown = [
        fmean(report) for report in zip(*[packet.angle for packet in all_of(packets, Motor)], strict=True)
    ]
    true = [fmean(angle) for angle in zip(*angles, strict=True)]
    # The firmware sees its fin where it wants it, and it stands 0.57 rad behind that by then.
    assert shown == pytest.approx([-math.pi / 2] * 4, abs=0.2)
    assert true[1] - true[0] == pytest.approx(-0.57, abs=0.15)
    assert true[2] - true[3] == pytest.approx(0, abs=0.15)


def test_a_jumping_gyroscope_and_a_disappearing_beacon(robot: EmulatedRobot, water: Simulator) -> None:
    quiet = all_of(robot.listen(1.0), Imu)
    assert max(abs(part) for packet in quiet for part in packet.rate) < 0.05
    assert last(robot.listen(0.3), Beacon).right
    water.set_fault("gyroscope", SimulatedFault(kind="spike", share=0.3, size=1.0))
    water.set_beacons(())
    loud = all_of(robot.listen(1.0), Imu)
    assert 0.9 < max(abs(part) for packet in loud for part in packet.rate) < 1.1
    assert not last(robot.listen(0.3), Beacon).right


@pytest.mark.usefixtures("built")
def test_a_requested_bus_error_reaches_the_firmware(
    tmp_path: Path, water: Simulator, messages: ZenohTransport
) -> None:
    build(ROOT / "firmware", "robot")
    with start("robot", tmp_path) as rig:
        process = WaterProcess(water, rig.process.socket, messages, SimulatedClock())
        thread = threading.Thread(target=process.run)
        thread.start()
        try:
            wait_for(lambda: is_wet(rig.board), "the water")
            robot = EmulatedRobot(rig)
            robot.listen(1.0)
            assert robot.status().faults == 0
            for sensor, fault in (
                ("accelerometer", DeviceFault.IMU),
                ("encoder2", DeviceFault.ENCODER_BACK_LEFT),
            ):
                messages.query("simulator/fault", {"sensor": sensor, "kind": "bus"}, SECONDS)
                assert robot.status().faults == fault
                messages.query("simulator/fault", {"sensor": sensor, "kind": "none"}, SECONDS)
                robot.listen(0.5)
                assert robot.status().faults == 0
        finally:
            process.end()
            thread.join()


def is_wet(board: EmulatorClient) -> bool:
    """Return True if another connection supplies the water."""
    try:
        board.sense(STILL_WATER)
    except BoardError:
        return True
    return False
