"""Flow control: a receiver without room reports it, and the sender waits, probes and continues."""

from robot_runtime.contract.packets import NOT_READY, Acknowledge
from robot_runtime.link.channel import Channel
from robot_runtime.link.framing import Decoder, Frame, Messages
from tests.runtime.link.line import KEY, PACKETS, numbered

GIVEN = 24


def acknowledging(acknowledged: int, held: int) -> Frame:
    return Frame(0, acknowledged, False, False, ((Acknowledge.type, bytes([held])),))


class ReadySender:
    """A channel with eight full frames to send, and its sent frames."""

    def __init__(self) -> None:
        self.channel = Channel(115_200, 4096, KEY)
        self.now = 0.0
        self._decoder = Decoder(PACKETS)
        self._decoder.key = KEY
        for message in numbered(18, GIVEN):
            self.channel.queue(message)

    def run(self, until: float) -> list[tuple[float, int, Messages]]:
        """Time, number and messages of the frames sent until then; polled only when due."""
        sent = []
        asked = 0
        while self.now < until:
            while data := self.channel.poll(self.now):
                (frame,) = self._decoder.feed(data)
                sent.append((self.now, frame.number, frame.messages))
            asked += 1
            self.now = min(max(self.channel.due(), self.now + 1e-6), until)
        assert asked < 1000, "it wants to be asked without having anything to do"
        return sent


def test_while_the_receiver_is_not_ready_only_the_oldest_frame_is_sent_once_a_second() -> None:
    sender = ReadySender()
    first = sender.run(0.04)
    assert [number for _, number, _ in first[:3]] == [0, 1, 2]
    sender.channel.receive(acknowledging(1, NOT_READY), sender.now)
    waited = sender.run(5.0)
    assert {number for _, number, _ in waited} == {1}
    assert len(waited) in (4, 5)
    sender.channel.receive(acknowledging(1, 0), sender.now)
    after = sender.run(5.04)
    assert [number for _, number, _ in after[:6]] == [1, 2, 3, 4, 5, 6]


def test_a_receiver_stays_not_ready_until_it_reports_readiness() -> None:
    sender = ReadySender()
    sender.run(0.04)
    sender.channel.receive(acknowledging(0, NOT_READY), sender.now)
    # A frame without this flag: telemetry, or a number in the other direction.
    sender.channel.receive(Frame(1, 0, False, False, numbered_message()), sender.now)
    assert len(sender.run(0.9)) <= 1


def numbered_message() -> Messages:
    (message,) = numbered(6, 1)
    return ((message[0], message[1:]),)


def test_held_frames_are_not_sent_again() -> None:
    sender = ReadySender()
    sender.run(0.04)
    sender.channel.receive(acknowledging(0, NOT_READY | 0b1), sender.now)
    sender.channel.receive(acknowledging(0, 0b1), sender.now)
    assert 1 not in [number for _, number, _ in sender.run(0.06)]


def test_dropped_frames_are_sent_again_as_soon_as_there_is_room() -> None:
    sender = ReadySender()
    first = sender.run(0.04)
    sender.channel.receive(acknowledging(0, NOT_READY), sender.now)
    sender.run(0.045)
    sender.channel.receive(acknowledging(0, 0), sender.now)
    # Long before any of them would be taken for lost.
    again = sender.run(0.06)
    assert [number for _, number, _ in again[:2]] == [number for _, number, _ in first[:2]] == [0, 1]


def test_frames_held_while_not_ready_are_sent_again_when_still_missing() -> None:
    sender = ReadySender()
    sender.run(0.04)
    sender.channel.receive(acknowledging(0, NOT_READY | 0b1), sender.now)
    # The receiver holds the second frame, but had no room to deliver it, and waits for it again.
    sender.channel.receive(acknowledging(1, 0), sender.now)
    assert 1 in [number for _, number, _ in sender.run(0.06)]
