"""A board whose time advances only on request, with a host at its serial port."""

import os
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Self

import serial

from robot_runtime.simulation.boards.emulator_process import EmulatorClient, EmulatorProcess
from robot_runtime.simulation.boards.firmware import make
from tests.waiting import SECONDS

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build/board"
SKETCHES = ROOT / "build/board_sketches"
OPTIBOOT = ROOT / "build/firmware/optiboot.hex"
CLOCK = 16_000_000
"""Hz."""


@cache
def build(folder: Path, *targets: str) -> None:
    """Build `folder`, or fail with make's output."""
    products = ROOT / "build/firmware"
    made = make(folder, *targets, products=products / "hil" if "HIL=1" in targets else products)
    assert made.returncode == 0, made.stdout + made.stderr


def wait_for(condition: Callable[[], bool], what: str) -> None:
    """Wait for another process's progress."""
    end = time.monotonic() + SECONDS
    while not condition():
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.0002)


class EmulatedPort:
    """The host's end of the serial line. No emulated time passes while it writes or reads."""

    def __init__(self, tty: Path, board: EmulatorClient, baud: float) -> None:
        self._board = board
        self._taken = board.stats()["bytes_from_host"]
        self._given = board.stats()["bytes_to_host"]
        self._serial = serial.Serial(str(tty), int(baud), timeout=0)

    def set_baud(self, baud: int) -> None:
        """Set the host's baud; the board applies it before later bytes."""
        self._serial.baudrate = baud
        wait_for(lambda: self._board.stats()["baud_host"] == baud, "the board to see the new speed")

    def write(self, data: bytes) -> None:
        """Write, and wait until the board has the bytes; none of them is on the line yet."""
        os.write(self._serial.fileno(), data)
        self._taken += len(data)
        wait_for(lambda: self._board.stats()["bytes_from_host"] == self._taken, "the board to take the bytes")

    def read(self) -> bytes:
        """Return all bytes that the board has handed over since the last call."""
        given = self._board.stats()["bytes_to_host"]
        data = bytearray()

        def complete() -> bool:
            data.extend(self._serial.read(4096))
            return len(data) >= given - self._given

        wait_for(complete, "the bytes from the board")
        self._given = given
        return bytes(data)

    def close(self) -> None:
        """Close; the board detects it before its time advances."""
        self._serial.close()


class BoardRig:
    """A paused board with this program on it, a connection to its socket, and its serial port."""

    def __init__(self, elf: Path | None, folder: Path, *options: str, baud: int = 115200) -> None:
        self.process = EmulatorProcess(PROGRAM, elf, folder / "tty", folder / "board", "--paused", *options)
        self.board = self.process.connect()
        self.port = EmulatedPort(self.process.tty, self.board, baud)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.port.close()
        self.board.close()
        self.process.stop()

    def exchange(self, data: bytes, seconds: float) -> bytes:
        """Write, let this much emulated time pass, and read."""
        self.port.write(data)
        self.board.run(seconds)
        return self.port.read()

    def run_until(self, condition: Callable[[], bool], step: float, limit: float) -> float:
        """Run in steps (s) until the condition holds; the emulated time it took. Fails beyond the limit."""
        start = end = self.board.stats()["time"]
        while not condition():
            assert end - start < limit, f"not within {limit} s"
            end = self.board.run(step)
        return end - start
