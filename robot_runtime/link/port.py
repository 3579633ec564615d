"""A serial port, opened for this process alone, with the file descriptor that select needs.

The board's UART and the emulated board's pseudo-terminal are opened alike. Reads and writes are done on the
descriptor itself: pyserial's own read asks the kernel once a byte, and its write calls a line full where the
process was late, though the kernel has taken all bytes.
"""

import os
import select
import termios
import time
from pathlib import Path
from typing import Self

import serial

from robot_runtime.link.link_driver import PortError

_READ_BYTES = 4096
_WRITE_SECONDS = 0.25
_PORTS = ("serial/by-id/*", "serial[0-9]", "ttyUSB*", "ttyACM*", "ttyAMA*", "ttyS0")
"""Serial ports below /dev; of a PC's many ttyS, nearly all without a plug, the first stands for them."""


class Port:
    """An open serial port. Raises PortError where it cannot be opened."""

    def __init__(self, path: str, baud: int) -> None:
        try:
            self._serial = serial.Serial(path, baud, timeout=0, exclusive=True)
        except (OSError, ValueError, termios.error) as problem:
            raise PortError(_explain(path, problem)) from problem
        self.path = path

    def wait(self, seconds: float) -> bool:
        """Wait for bytes; return True if some came. Raise PortError where the port is gone."""
        try:
            return bool(select.select([self._serial.fileno()], [], [], max(seconds, 0.0))[0])
        except (OSError, ValueError) as problem:
            raise PortError(f"{self.path} was closed") from problem

    def read(self) -> bytes:
        """Return all received bytes. Raise PortError where the port is gone."""
        try:
            data = os.read(self._serial.fileno(), _READ_BYTES)
        except BlockingIOError:
            return b""
        except OSError as problem:
            raise PortError(
                f"{self.path} went away: is the board powered and its cable in place?"
            ) from problem
        if not data:
            raise PortError(f"{self.path} went away: is the board powered and its cable in place?")
        return data

    def write(self, data: bytes) -> None:
        """Hand all bytes to the line. Raise PortError where it does not take them in time."""
        unwritten = memoryview(data)
        end = time.monotonic() + _WRITE_SECONDS
        try:
            while unwritten:
                self._wait_for_room(end)
                unwritten = unwritten[os.write(self._serial.fileno(), unwritten) :]
        except (OSError, ValueError) as problem:
            raise PortError(f"{self.path} takes no more bytes: {problem}") from problem

    def _wait_for_room(self, end: float) -> None:
        # Asked once also where the time is over: the process may have been late, not the line.
        if not select.select([], [self._serial.fileno()], [], max(end - time.monotonic(), 0.0))[1]:
            raise TimeoutError(f"it stayed full for {_WRITE_SECONDS} s")

    def close(self) -> None:
        """Close the port; closing twice does nothing."""
        self._serial.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def list_ports(devices: Path = Path("/dev")) -> list[str]:
    """Return the serial ports of this computer, each once, by its lasting name where it has one."""
    names: dict[Path, str] = {}
    for pattern in _PORTS:
        for path in sorted(devices.glob(pattern)):
            names.setdefault(path.resolve(), str(path))
    return list(names.values())


def _explain(path: str, problem: Exception) -> str:
    number = getattr(problem, "errno", None)
    if isinstance(problem, ValueError):
        return f"{path} does not take this baud rate: {problem}"
    if number in (2, 6, 19):
        others = ", ".join(list_ports()) or "none"
        return (
            f"{path} does not exist: is the board (or the emulated board) running, and is link.port right? "
            f"Serial ports that are there: {others}"
        )
    if number == 13:
        return f"{path} may not be opened: add this user to the group dialout and sign in again"
    if number == 11 or "lock" in str(problem):
        return f"{path} is in use by another program: end it first"
    return f"{path} cannot be opened: {problem}"
