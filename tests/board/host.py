"""A board that runs the firmware, and a host connected to it, in emulated time."""

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from robot_runtime.contract.packets import (
    DEFINITIONS_HASH,
    Heartbeat,
    Hello,
    Navigation,
    Packet,
    Start,
    Status,
    StatusFlag,
    Stop,
    decode,
)
from robot_runtime.link.session import LinkSession
from tests.board.rig import OPTIBOOT, ROOT, BoardRig
from tests.line_end import LineEnd

FIRMWARE = ROOT / "build/firmware"
BAUD = 250_000
TICK = 0.01
"""s; the firmware's own tick."""
HEARTBEAT_TICKS = 10
P = TypeVar("P", bound=Packet)


class EmulatedRobot:
    """A paused board with the firmware, and a host in step with it."""

    def __init__(self, rig: BoardRig) -> None:
        self.rig = rig
        self.board = rig.board
        self.heard: list[Packet] = []
        self._end = LineEnd(is_host=True)
        self._ticks = 0
        self._passed = 0.0

    def send(self, *packets: Packet) -> None:
        """Write these packets to the host's port; they are sent as emulated time advances."""
        self.rig.port.write(self._end.say(packets, self._passed))

    def listen(self, seconds: float) -> list[Packet]:
        """Packets of the board in this emulated time while the host is silent."""
        self.board.run(seconds)
        self._passed += seconds
        messages = self._end.hear(self.rig.port.read(), self._passed)
        assert self._end.invalid == 0
        packets = [decode(type_, payload) for type_, payload in messages]
        self.heard += packets
        return packets

    def converse(self, seconds: float, command: Navigation | None = None) -> list[Packet]:
        """Packets of the board in this emulated time, while HEARTBEAT and the command, if any, are sent."""
        packets: list[Packet] = []
        for _ in range(round(seconds / TICK)):
            if self._ticks % HEARTBEAT_TICKS == 0:
                self.send(Heartbeat(time=0), *([command] if command else []))
            self._ticks += 1
            packets += self.listen(TICK)
        return packets

    def greet(self) -> Hello:
        """Send HELLO until it is answered."""
        self.send(Hello(definitions=DEFINITIONS_HASH, epoch=77, credit=4096))
        return last(self.listen(0.05), Hello)

    def arm(self) -> None:
        """Greet, send steady traffic for long enough, and START."""
        hello = self.greet()
        self.converse(0.7)
        self.send(Start(epoch=hello.epoch))
        assert self.status().flags & StatusFlag.ARMED

    def stop(self) -> None:
        self.send(Stop())

    def status(self) -> Status:
        """Return the next status of the board, which may describe the last 100 ms."""
        return last(self.converse(0.2), Status)

    def until(self, holds: Callable[[Status], bool], limit: float) -> float:
        """Receive until a status meets the condition; return the emulated time. Fails beyond the limit."""
        passed = 0.0
        while passed <= limit:
            packets = self.listen(TICK)
            passed += TICK
            if any(isinstance(packet, Status) and holds(packet) for packet in packets):
                return passed
        raise AssertionError(f"not within {limit} s")


def all_of(packets: list[Packet], cls: type[P]) -> list[P]:
    return [packet for packet in packets if isinstance(packet, cls)]


def last(packets: list[Packet], cls: type[P]) -> P:
    result = all_of(packets, cls)
    assert result, f"no {cls.__name__} in {packets}"
    return result[-1]


def start(name: str, folder: Path, *options: str, boot_loader: bool = True) -> BoardRig:
    """Start a board with this program of the firmware, behind the boot loader of the robot's board."""
    loader = ("--bootloader", str(OPTIBOOT)) if boot_loader else ()
    return BoardRig(FIRMWARE / f"{name}.elf", folder, *loader, *options, baud=BAUD)


class EmulatedHost:
    """The runtime's own session with a paused board; both see emulated time, tick by tick."""

    def __init__(self, rig: BoardRig, baud: int) -> None:
        self.rig = rig
        self.board = rig.board
        self.session = LinkSession(77, baud)
        self.command: Navigation | None = None
        self.heard: list[tuple[float, Packet]] = []
        self.now = 0.0

    def say(self, *packets: Packet) -> None:
        """Pass these packets to the session, which sends them as the line allows."""
        self._write(self.session.send(packets, self.now))

    def run(self, seconds: float) -> list[tuple[float, Packet]]:
        """Packets in this emulated time, with their times; the command, if any, is sent at 10 Hz."""
        before = len(self.heard)
        for _ in range(round(seconds / TICK)):
            self.board.run(TICK)
            self.now += TICK
            messages = self.session.receive(self.rig.port.read(), self.now)
            self.heard += [(self.now, decode(message.type, message.payload)) for message in messages]
            if self.command is not None and round(self.now / TICK) % HEARTBEAT_TICKS == 0:
                self.say(self.command)
            self._write(self.session.poll(self.now))
        return self.heard[before:]

    def until(self, holds: Callable[[], bool], limit: float) -> float:
        """Emulated s until the condition holds. Fails beyond the limit."""
        start = self.now
        while not holds():
            assert self.now - start < limit, f"not within {limit:.2f} s"
            self.run(TICK)
        return self.now - start

    def last(self, cls: type[P]) -> P:
        """Return the newest packet of this type."""
        return last([packet for _, packet in self.heard], cls)

    def _write(self, data: bytes) -> None:
        if data:
            self.rig.port.write(data)
