"""The firmware's stack and timing in ten minutes while the line is full both ways."""

import tempfile
from itertools import cycle
from pathlib import Path

from bench.chip import build_for
from bench.stack_bound import RAM_BYTES, count_static, section_sizes
from robot_runtime.contract.packets import Navigation, RequestCalibration, Start, Status, StatusFlag, encode
from robot_runtime.link.session import NO_BOOT, LinkSession
from tests.board.host import FIRMWARE
from tests.board.rig import BoardRig

_SECTIONS_IN_FLASH = (".text", ".data")

BAUD = 250_000
_FASTEST_BAUD = 500_000
_SECONDS = 600.0
_STEP = 0.002
_STEADY = 0.7
_OTHER_BOOT = 9999
_VOID_STARTS = 17
_BACKLOG = 200
# A little less than the line takes, so that the port's buffer does not fill up in ten minutes.
_PACE = 0.995
_SHORTEST_WAIT = 1e-5
_BITS_PER_BYTE = 10


def measure() -> dict[str, float]:
    """Measure stack and loop in ten emulated minutes of swimming under full load.

    At the default baud and, where the name ends in it, at the fastest. The robot is armed and swims. It says
    all it can: its telemetry, and a frame of text at every tick, since there is always a START of another
    boot among the host's that it has to refuse in words. The host's line never idles: reliable frames full of
    STARTs (the others are void) go out as the board's credit lets them, and a NAVIGATION wherever nothing
    else may. `line_to_board` and `line_to_host` are the shares of the line that this took; `bytes_lost` are
    those that the chip had no room for, and which the link sent again.
    """
    elf = FIRMWARE / "robot.elf"
    figures = _load(elf, BAUD)
    room = RAM_BYTES - count_static(elf)
    figures["stack_high_water_bytes"] = room - figures.pop("stack_free")
    fastest = _load(build_for(_FASTEST_BAUD, "robot"), _FASTEST_BAUD)
    del fastest["stack_free"]
    return {
        **{f"firmware.{name}": value for name, value in figures.items()},
        **{f"firmware.{name}.{_FASTEST_BAUD}": value for name, value in fastest.items()},
    }


def _load(elf: Path, baud: int) -> dict[str, float]:
    with tempfile.TemporaryDirectory() as folder, BoardRig(elf, Path(folder), baud=baud) as rig:
        host = FloodHost(rig, baud)
        host.arm()
        host.flood(1.0)
        host.worst = 0
        sent, heard, began = host.sent, host.heard, host.now
        host.flood(_SECONDS)
        status = host.status
        if status is None or not status.flags & StatusFlag.ARMED:
            raise RuntimeError("the board did not stay armed")
        capacity = (host.now - began) * baud / _BITS_PER_BYTE
        return {
            "loop_worst_us": host.worst,
            "missed_ticks": status.missed_ticks,
            "bytes_lost": host.lost,
            "line_to_board": (host.sent - sent) / capacity,
            "line_to_host": (host.heard - heard) / capacity,
            "stack_free": status.stack_free,
        }


class FloodHost:
    """The product's own session at the port of a paused board."""

    def __init__(self, rig: BoardRig, baud: int) -> None:
        self.now = rig.board.stats()["time"]
        self.sent = 0
        self.heard = 0
        self.worst = 0
        self.lost = 0
        self.status: Status | None = None
        self.faults = 0
        self._rig = rig
        self._byte_time = _BITS_PER_BYTE / (_PACE * baud)
        self._session = LinkSession(1, baud)
        self._epochs = cycle([_OTHER_BOOT] + [NO_BOOT] * _VOID_STARTS)
        self._line_free = self.now

    def arm(self) -> None:
        """Send START, once the board has heard enough."""
        self._run(_STEADY)
        board = self._session.board
        if board is None:
            raise RuntimeError("the board did not answer")
        self._pass(self._session.send([Start(epoch=board.epoch)], self.now))
        self._run(_STEP)

    def flood(self, seconds: float) -> None:
        """Pass time with more to send than the line carries."""
        end = self.now + seconds
        while self.now < end:
            channel = self._session._channel
            for _ in range(len(channel.pending()), _BACKLOG):
                channel.queue(encode(Start(epoch=next(self._epochs))))
                channel.queue(encode(RequestCalibration()))
            self._pass(self._fill())

    def _run(self, seconds: float) -> None:
        end = self.now + seconds
        while self.now < end:
            self._pass(self._session.poll(self.now))

    def _fill(self) -> bytes:
        """Return bytes that fill the line for a step: the session's, otherwise another command."""
        side = 1.0 if self.now % 2 < 1 else -1.0
        command = Navigation(x=0.5, y=0.0, z=side, roll=0.0, pitch=0.0, yaw=0.5 * side)
        data = b""
        at = max(self._line_free, self.now)
        while at < self.now + _STEP:
            frame = self._session.poll(at) or self._session.send([command], at)
            at += max(len(frame) * self._byte_time, _SHORTEST_WAIT)
            data += frame
        self._line_free = at
        return data

    def _pass(self, data: bytes) -> None:
        self.sent += len(data)
        self._rig.port.write(data)
        self.now = self._rig.board.run(_STEP)
        answer = self._rig.port.read()
        self.heard += len(answer)
        for message in self._session.receive(answer, self.now):
            if message.type == Status.type:
                before, self.status = self.status, Status.from_bytes(message.payload)
                self.lost += (self.status.bytes_lost - (before.bytes_lost if before else 0)) & 0xFFFF
                self.worst = max(self.worst, self.status.loop_worst)
                self.faults |= self.status.faults


def count_flash(elf: Path) -> int:
    """Return the bytes of a program in the flash memory."""
    sizes = section_sizes(elf)
    return sum(sizes.get(name, 0) for name in _SECTIONS_IN_FLASH)
