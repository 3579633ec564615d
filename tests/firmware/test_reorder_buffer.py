"""The firmware's reorder buffer: early frames are stored, acknowledged, and delivered in order."""

import ctypes

import pytest

from robot_runtime.contract.packets import Acknowledge, Packet, Start, encode
from robot_runtime.contract.packets import TestMsg as NumberMsg
from robot_runtime.link.framing import Decoder, assemble
from robot_runtime.link.session import session_key
from tests.firmware.robot import CompiledRobot, hello

HOST_EPOCH = 7
NUMBERS_IN_A_FRAME = 19


class GreetedHost:
    """A host after its greeting, which sends frames of any number."""

    def __init__(self, robot: CompiledRobot) -> None:
        robot.say(hello(epoch=HOST_EPOCH))
        robot.run(100)
        self.epoch = int(robot.firmware.board_epoch())
        self._robot = robot
        self._key = session_key(HOST_EPOCH, self.epoch)

    def send(self, number: int, *packets: Packet) -> None:
        self._robot.send(assemble(b"".join(map(encode, packets)), True, number, 0, self._key))

    def acknowledgement(self) -> tuple[int, int]:
        """Return the number that the board waits for, and bits of the held frames, after a few ticks."""
        firmware = self._robot.firmware
        room = ctypes.create_string_buffer(1 << 16)
        firmware.board_take(room, len(room))
        firmware.robot_run(self._robot._robot, 50)
        decoder = Decoder()
        decoder.key = self._key
        size = firmware.board_take(room, len(room))
        *_, last = decoder.feed(room.raw[:size])
        return last.acknowledged, next(
            (each[0] for type_, each in last.messages if type_ == Acknowledge.type), 0
        )


@pytest.fixture
def host(robot: CompiledRobot) -> GreetedHost:
    return GreetedHost(robot)


def test_an_early_frame_is_acknowledged_and_delivered_in_its_turn(host: GreetedHost) -> None:
    for number in (1, 2, 4):
        host.send(number, NumberMsg(number=number))
    assert host.acknowledgement() == (0, 0b1011)
    host.send(0, NumberMsg(number=0))
    assert host.acknowledgement() == (3, 0b1)
    host.send(3, NumberMsg(number=3))
    assert host.acknowledgement() == (5, 0)


def test_a_frame_without_room_is_not_acknowledged(host: GreetedHost) -> None:
    for number in (1, 2, 3, 4):
        host.send(number, *[NumberMsg(number=number)] * NUMBERS_IN_A_FRAME)
    host.send(5, NumberMsg(number=5))
    assert host.acknowledgement() == (0, 0b10011)
    for number in (0, 3, 4):
        host.send(number, NumberMsg(number=number))
    assert host.acknowledgement() == (6, 0)


def test_a_frame_outside_the_window_is_an_old_one(host: GreetedHost) -> None:
    host.send(7, NumberMsg(number=7))
    assert host.acknowledgement() == (0, 0)


def test_a_start_is_never_held_since_a_stop_could_not_void_it(host: GreetedHost) -> None:
    host.send(1, NumberMsg(number=1), Start(epoch=host.epoch))
    host.send(2, NumberMsg(number=2))
    assert host.acknowledgement() == (0, 0b10)
    host.send(0, NumberMsg(number=0))
    assert host.acknowledgement() == (1, 0b1)
