"""What the runtime does where nobody looks after the robot any more."""

import time
from collections.abc import Iterator

import pytest

from robot_runtime.heartbeat import Heartbeat
from robot_runtime.lifetime import HEARTBEAT
from robot_runtime.messages import Messages
from robot_runtime.packets import Stop
from tests.runtime.control.test_supervisor import Rig

DEADLINE = 10.0


@pytest.fixture
def messages() -> Iterator[Messages]:
    with Messages("turtle") as made:
        yield made


@pytest.fixture
def rig() -> Rig:
    rig = Rig()
    rig.ready()
    return rig


def hear(heartbeat: Heartbeat, rig: Rig, messages: Messages) -> None:
    """Send a heartbeat, and wait until it has come."""
    messages.publish(HEARTBEAT, b"")
    end = time.monotonic() + DEADLINE
    while heartbeat.heard != rig.clock.now():
        assert time.monotonic() < end
        time.sleep(0.002)


def test_an_armed_robot_is_stopped_when_the_server_falls_silent(rig: Rig, messages: Messages) -> None:
    heartbeat = Heartbeat(rig.supervisor, messages, rig.clock, 4.0)
    rig.supervisor.arm()
    for _ in range(3):
        rig.clock.forward(4.0)
        heartbeat.look()
        assert rig.supervisor.armed
        hear(heartbeat, rig, messages)
    rig.clock.forward(4.1)
    heartbeat.look()
    assert not rig.supervisor.armed
    assert (rig.events[-1].severity, rig.events[-1].text) == (
        "caution",
        "The server has been silent for 4 s.",
    )


def test_a_robot_that_is_not_armed_is_left_alone(rig: Rig, messages: Messages) -> None:
    heartbeat = Heartbeat(rig.supervisor, messages, rig.clock, 4.0)
    rig.clock.forward(100.0)
    before = len(rig.board.sent)
    heartbeat.look()
    assert not any(isinstance(packet, Stop) for packet in rig.board.sent[before:])
    assert rig.events == []
