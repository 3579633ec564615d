"""The firmware compiled for this computer, on the emulated board's devices."""

from collections.abc import Iterator
from math import inf
from pathlib import Path

import pytest

from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    Beacon,
    DeviceFault,
    Hello,
    Imu,
    Motor,
    ResetCause,
    Status,
)
from robot_runtime.experiments.scenario.boards import BUILD
from robot_runtime.link.framing import Decoder
from robot_runtime.simulation.boards.emulator_process import STILL_WATER, BoardError
from robot_runtime.simulation.boards.host_board import HostBoard
from robot_runtime.simulation.boards.stepped_board import PERIOD
from robot_runtime.simulation.water.sensors import Reading
from robot_runtime.simulation.water.simulator import FinMotion

LIBRARY = BUILD / "libhost_board.so"


class HostBoardRig:
    """A board without a host, with readings that the test sets."""

    def __init__(self) -> None:
        self.reading = STILL_WATER
        self.fins: list[FinMotion] = []
        self.board = HostBoard(LIBRARY, self._feel)
        self._decoder = Decoder()

    def run(self, seconds: float) -> dict[int, list[bytes]]:
        """Run for this time; return the board's messages by type."""
        answer: dict[int, list[bytes]] = {}
        for frame in self._decoder.feed(self.board.run(round(seconds / PERIOD))):
            for type_, payload in frame.messages:
                answer.setdefault(type_, []).append(payload)
        return answer

    def _feel(self, fins: FinMotion) -> Reading:
        self.fins.append(fins)
        return self.reading


@pytest.fixture
def rig() -> Iterator[HostBoardRig]:
    rig = HostBoardRig()
    with rig.board:
        yield rig


def test_the_board_sends_hello_and_its_sensor_readings(rig: HostBoardRig) -> None:
    rig.reading = STILL_WATER._replace(force=(1.0, -2.0, -9.0), battery=7.0)
    answer = rig.run(1.0)
    assert Hello.from_bytes(answer[Hello.type][0]).definitions == DEFINITIONS_HASH
    assert Imu.from_bytes(answer[Imu.type][-1]).force == pytest.approx((1.0, -2.0, -9.0), abs=0.01)
    status = Status.from_bytes(answer[Status.type][-1])
    assert status.battery == pytest.approx(7.0, abs=0.02)
    assert status.faults == 0
    assert (status.missed_ticks, status.bytes_lost, status.frames_invalid) == (0, 0, 0)
    assert len(rig.fins) == round(1 / PERIOD)
    assert Motor.from_bytes(answer[Motor.type][-1]).angle == pytest.approx(rig.fins[-1].angles, abs=0.005)


@pytest.mark.parametrize(
    ("device", "fault"),
    [
        ("imu", DeviceFault.IMU),
        ("pressure", DeviceFault.PRESSURE),
        ("encoder2", DeviceFault.ENCODER_BACK_LEFT),
    ],
)
def test_a_device_that_does_not_answer_is_reported_until_it_does(
    rig: HostBoardRig, device: str, fault: DeviceFault
) -> None:
    rig.board.fault(device, "absent")
    assert Status.from_bytes(rig.run(1.0)[Status.type][-1]).faults == fault
    rig.board.fault(device, "none")
    assert Status.from_bytes(rig.run(1.0)[Status.type][-1]).faults == 0


def test_a_board_with_mistakes(rig: HostBoardRig) -> None:
    rig.board.mistake("imu-strap")
    rig.board.mistake("divider-wrong:0.9")
    rig.board.mistake("beacons-swapped")
    rig.reading = STILL_WATER._replace(beacon_right=True, battery=8.0)
    answer = rig.run(1.0)
    status = Status.from_bytes(answer[Status.type][-1])
    assert status.faults == DeviceFault.IMU
    assert status.battery == pytest.approx(7.2, abs=0.02)
    beacon = Beacon.from_bytes(answer[Beacon.type][-1])
    assert (beacon.right, beacon.left) == (0, 1)
    with pytest.raises(BoardError, match="there is no mistake 'imu'"):
        rig.board.mistake("imu")


def test_a_reset_is_another_boot(rig: HostBoardRig) -> None:
    first = Hello.from_bytes(rig.run(0.1)[Hello.type][0])
    rig.board.reset()
    status = Status.from_bytes(rig.run(0.3)[Status.type][-1])
    assert status.epoch == first.epoch + 1
    assert status.reset_cause == ResetCause.EXTERNAL


def test_the_line_can_be_cut_stalled_and_disturbed(rig: HostBoardRig) -> None:
    rig.board.line("line from_board cut on")
    assert rig.board.run(100) == b""
    rig.board.line("line from_board cut off")
    rig.board.line("line from_board stall 0.2")
    assert rig.board.run(39) == b""
    assert len(rig.board.run(20)) > 1000
    rig.board.seed_line(3)
    rig.board.line("line from_board bit_errors 0.001")
    assert len(rig.run(1.0)[Imu.type]) < 95
    rig.board.line("line from_board clean")
    rig.run(0.1)
    assert len(rig.run(1.0)[Imu.type]) >= 99


def test_the_line_s_throughput_is_limited_by_its_speed(rig: HostBoardRig) -> None:
    rig.run(0.2)
    rig.board.write(bytes(1000))
    lost = Status.from_bytes(rig.run(0.5)[Status.type][-1])
    assert lost.bytes_lost == 0
    assert lost.frames_invalid == 0


def test_invalid_faults_are_refused(rig: HostBoardRig) -> None:
    with pytest.raises(BoardError, match="no device 'rudder'"):
        rig.board.fault("rudder", "absent")
    with pytest.raises(BoardError, match="unknown command"):
        rig.board.line("line to_board cut perhaps")
    with pytest.raises(BoardError, match="unknown command"):
        rig.board.line("line to_board stall 4000")
    rig.reading = STILL_WATER._replace(pressure=inf)
    with pytest.raises(BoardError, match="refused this reading"):
        rig.board.run(1)


def test_two_boards_are_independent(rig: HostBoardRig) -> None:
    other = HostBoardRig()
    with other.board:
        other.board.fault("imu", "absent")
        for _ in range(20):
            mine, its = rig.run(0.1), other.run(0.1)
        assert Status.from_bytes(mine[Status.type][-1]).faults == 0
        assert Status.from_bytes(its[Status.type][-1]).faults == DeviceFault.IMU


def test_a_missing_library_is_reported(tmp_path: Path) -> None:
    with pytest.raises(BoardError, match="`make firmware` builds it"):
        HostBoard(tmp_path / "libhost_board.so", lambda _: STILL_WATER)
