"""Counts of damaged frames on the serial line: each end counts exactly the damaged ones.

The emulated chip and the runtime's end of the line, in simulated time. In each chosen frame one bit is
changed, but never so that a byte becomes the zero that ends a frame: then one damaged frame is one, and every
single bit is one that the CRC must see.
"""

import random
from dataclasses import dataclass

from cobs.cobs import decode

from robot_runtime.config import LinkConfig
from robot_runtime.contract.packets import PACKETS, Status
from robot_runtime.contract.topics import STATUS
from robot_runtime.experiments.scenario.boards import BUILD
from robot_runtime.simulation.boards.emulated_board import EmulatedBoard
from robot_runtime.simulation.boards.emulator_process import Water
from robot_runtime.simulation.boards.firmware import firmware_path
from tests.runtime.control.flight import Flight

SHARE = 0.02
"""Share of damaged frames."""
SETTLE = 1.0
"""s, in which the next frames tell what was missing."""


@dataclass
class DamageCounts:
    """Damaged frames of one direction, and the receiver's count of them.

    `unreliable` of them are sent once; the host counts as `missed` what the numbers show to be missing.
    """

    damaged: int = 0
    invalid: int = 0
    unreliable: int = 0
    missed: int = 0


class NoisyBoard(EmulatedBoard):
    """A board on a line that damages frames."""

    def __init__(self, water: Water, seed: int) -> None:
        self.to_host, self.to_board = DamageCounts(), DamageCounts()
        self.share = 0.0
        self._chance = random.Random(seed)
        self._partial = b""
        super().__init__(BUILD / "board", firmware_path(BUILD, LinkConfig().baud, ".elf"), water)

    def run(self, periods: int) -> bytes:
        """Run for this time; return the bytes for the host, some of them damaged."""
        *frames, self._partial = (self._partial + super().run(periods)).split(b"\0")
        return b"".join(self._pass(frame, self.to_host) + b"\0" for frame in frames)

    def write(self, data: bytes) -> None:
        """Put these frames on the line, some of them damaged."""
        frames = data.split(b"\0")
        assert frames.pop() == b"", "the host writes whole frames"
        super().write(b"".join(self._pass(frame, self.to_board) + b"\0" for frame in frames))

    def _pass(self, frame: bytes, counts: DamageCounts) -> bytes:
        if not frame or self._chance.random() >= self.share:
            return frame
        counts.damaged += 1
        counts.unreliable += not PACKETS[decode(frame)[1]].reliable
        while True:
            position, bit = self._chance.randrange(len(frame)), self._chance.randrange(8)
            changed = frame[position] ^ 1 << bit
            if changed:
                return frame[:position] + bytes([changed]) + frame[position + 1 :]


def count(seconds: float, seed: int) -> tuple[DamageCounts, DamageCounts]:
    """Run for this time on such a line; return the counts of both directions."""
    wires: list[NoisyBoard] = []

    def make(water: Water) -> NoisyBoard:
        wires.append(NoisyBoard(water, seed))
        return wires[0]

    with Flight(make) as flight:
        wire = wires[0]
        notices: list[Status] = []
        flight.robot.bus.on_row(STATUS, lambda _, record: notices.append(Status.from_bytes(record)))
        flight.arm()
        flight.run(SETTLE)
        before, board_before = flight.robot.link.statistics(), notices[-1].frames_invalid
        wire.share = SHARE
        flight.run(seconds)
        wire.share = 0.0
        flight.run(SETTLE)
        after = flight.robot.link.statistics()
        wire.to_host.invalid = after.frames_invalid - before.frames_invalid
        wire.to_host.missed = after.frames_missed - before.frames_missed
        wire.to_board.invalid = notices[-1].frames_invalid - board_before
    return wire.to_host, wire.to_board
