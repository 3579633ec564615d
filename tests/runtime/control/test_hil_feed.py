import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.contract.documents import Event
from robot_runtime.contract.packets import Packet, Sense
from robot_runtime.control.hil_feed import SILENCE, HilFeed

WORD = Sense(
    pressure=101_325,
    temperature=20.0,
    rate=(0.0, 0.0, 0.0),
    force=(0.0, 0.0, -9.81),
    right=1,
    left=0,
    battery=8.2,
)


class HilFeedRig:
    def __init__(self) -> None:
        self.clock = SimulatedClock(100.0)
        self.sent: list[Packet] = []
        self.events: list[Event] = []
        self.loop = HilFeed(self.clock, self.sent.append, self.events.append)


def test_a_message_is_passed_to_the_board_unchanged() -> None:
    rig = HilFeedRig()
    rig.loop.forward(WORD.to_bytes())
    assert [packet.to_bytes() for packet in rig.sent] == [WORD.to_bytes()]
    assert rig.loop.refusals() == []


def test_the_simulator_s_arrival_is_reported_once_and_its_loss_detected() -> None:
    rig = HilFeedRig()
    rig.loop.tick()
    assert rig.events == []
    assert "There is no simulator" in rig.loop.refusals()[0]
    rig.loop.forward(WORD.to_bytes())
    for _ in range(3):
        rig.loop.tick()
    rig.clock.forward(SILENCE * 1.01)
    for _ in range(3):
        rig.loop.tick()
    assert [(event.kind, event.severity) for event in rig.events] == [("simulator", "info")]
    assert rig.loop.lost
    assert rig.loop.refusals() != []


def test_an_invalid_message_is_dropped_and_does_not_count(caplog: pytest.LogCaptureFixture) -> None:
    rig = HilFeedRig()
    rig.loop.forward(WORD.to_bytes()[:-1])
    assert (rig.sent, rig.loop.present) == ([], False)
    assert "invalid Sense" in caplog.text
