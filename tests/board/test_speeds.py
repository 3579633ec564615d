"""The robot's firmware at every speed of the line, with the runtime's own session, in emulated time."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from robot_runtime.contract.packets import (
    FRAME_BYTES_MAX,
    BoardEvent,
    Depth,
    Imu,
    Motor,
    Navigation,
    Packet,
    Start,
    Status,
    StatusFlag,
    Stop,
)
from robot_runtime.link.session import SessionStage
from robot_runtime.link.timing import airtime, periods
from robot_runtime.simulation.boards.firmware import build_firmware, firmware_path
from tests.board.host import TICK, EmulatedHost
from tests.board.rig import ROOT, BoardRig

BUILD = ROOT / "build"
DOWN = Navigation(x=0.0, y=0.0, z=1.0, roll=0.0, pitch=0.0, yaw=0.0)
SPEEDS = (1200, 9600, 115_200, 250_000, 500_000)
STOP_BYTES = 9
ROUNDS = 6
"""Of the rarest telemetry, over which rates are counted."""

Join = Callable[[int, int], EmulatedHost]


@pytest.fixture
def join(built: None, tmp_path: Path) -> Iterator[Join]:  # noqa: ARG001 - the board comes first
    """Starts a board with the firmware for one baud, and a host with the same or another one."""
    with ExitStack() as boards:

        def make(board_baud: int, host_baud: int) -> EmulatedHost:
            build_firmware(BUILD, board_baud)
            elf = firmware_path(BUILD, board_baud, ".elf")
            return EmulatedHost(boards.enter_context(BoardRig(elf, tmp_path, baud=host_baud)), host_baud)

        yield make


@pytest.mark.parametrize("baud", SPEEDS)
def test_telemetry_at_each_speed_is_what_the_line_carries(join: Join, baud: int) -> None:
    host = join(baud, baud)
    frame = airtime(FRAME_BYTES_MAX, baud)
    host.until(lambda: host.session.stage is SessionStage.ESTABLISHED, 0.5 + 4 * frame)
    # The events of the start arrive beside the telemetry.
    host.until(lambda: count(host.heard, BoardEvent) == 7, 1.0 + 16 * frame)
    host.run(1.0 + 3 * periods(baud)[Status])

    measured = max(ROUNDS * periods(baud)[Status], 2.0)
    heard = host.run(measured)
    for kind, period in periods(baud).items():
        assert count(heard, kind) == pytest.approx(measured / period, rel=0.15), kind.__name__
    # Telemetry is new: it waited only for bytes that were on the line already.
    clock = host.board.stats()["time"] - host.now
    ages = [
        at + clock - packet.time * 1e-6 for at, packet in heard if isinstance(packet, Depth | Imu | Motor)
    ]
    assert max(ages) < 2 * frame + 3 * TICK

    host.command = DOWN
    host.say(Start(epoch=host.last(Status).epoch))
    host.until(lambda: bool(host.last(Status).flags & StatusFlag.ARMED), 1.0 + airtime(96, baud))
    host.run(1.0)
    swam = host.run(3.0)
    assert not any(packet.flags & StatusFlag.NEUTRAL for _, packet in swam if isinstance(packet, Status))
    assert host.board.fins().powered
    host.command = None
    host.say(Stop())
    host.until(lambda: not host.board.fins().powered, airtime(FRAME_BYTES_MAX + STOP_BYTES, baud) + 3 * TICK)

    host.run(3 * periods(baud)[Status])
    answer = host.session.statistics()
    status = host.last(Status)
    assert (answer.frames_missed, answer.frames_invalid) == (0, 0)
    assert (status.frames_invalid, status.bytes_lost, status.debug_lost) == (0, 0, 0)
    assert host.board.stats()["overruns"] == 0


@pytest.mark.parametrize(("board_baud", "host_baud"), [(250_000, 9600), (9600, 250_000), (1200, 500_000)])
def test_a_wrong_speed_is_reported(join: Join, board_baud: int, host_baud: int) -> None:
    host = join(board_baud, host_baud)
    host.until(lambda: host.session.garbled, 5.0)
    assert host.session.stage is SessionStage.GREETING
    assert host.session.statistics().frames_received == 0


def count(heard: list[tuple[float, Packet]], cls: type[Packet]) -> int:
    return sum(isinstance(packet, cls) for _, packet in heard)
