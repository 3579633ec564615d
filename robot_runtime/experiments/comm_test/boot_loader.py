"""Identifies a board's boot loader before anything is written, by two questions of STK500 (Atmel AVR061)."""

import re
import time
from dataclasses import dataclass

import serial

from robot_runtime.experiments.comm_test.reset_pin import Pull
from robot_runtime.experiments.comm_test.upload import BOOT_BAUD, UploadError
from robot_runtime.link.link_driver import PortError

OLD_BAUD = 57600
"""bit/s of the boot loader that Arduino Pro Minis are sold with."""
PATIENCE = 1.5
"""s in which a boot loader answers after a reset: the old one first blinks."""
POLL = 0.2
"""s between two greetings: the old one gives up after five bytes that it does not understand."""
OPTIBOOT_MAJOR = 3
"""First major version of optiboot; ATmegaBOOT is 1.16."""
_GREETING, _GREETED = b"0 ", b"\x14\x10"
_VALUE = re.compile(rb"\x14(.)\x10", re.DOTALL)
_MAJOR, _MINOR = b"A\x81 ", b"A\x82 "


@dataclass(frozen=True, slots=True)
class BootLoader:
    """A boot loader's version, and its speed in bit/s."""

    major: int
    minor: int
    baud: int


def identify(port: str, pull: Pull) -> BootLoader | None:
    """Return the boot loader of the board at this port; None if none answers.

    Raise PortError, and the errors of `pull`.
    """
    for baud in (BOOT_BAUD, OLD_BAUD):
        pull()
        try:
            with serial.Serial(port, baud, timeout=POLL) as line:
                if (
                    _greet(line)
                    and (major := _ask(line, _MAJOR)) is not None
                    and (minor := _ask(line, _MINOR)) is not None
                ):
                    return BootLoader(major, minor, baud)
        except (OSError, serial.SerialException) as problem:
            raise PortError(f"{port} cannot be used: {problem}") from problem
    return None


def refuse_endless_resets(port: str, pull: Pull) -> None:
    """Raise UploadError where the boot loader does not survive the watchdog of the robot's firmware."""
    loader = identify(port, pull)
    if loader is not None and loader.major < OPTIBOOT_MAJOR:
        raise UploadError(
            f"the board has the boot loader ATmegaBOOT {loader.major}.{loader.minor} ({loader.baud} bit/s), "
            "which leaves the watchdog on: after the first hang of the robot's firmware it would reset for "
            "ever, until the power is cut. Nothing was written. Burn optiboot with a programmer: in the "
            "Arduino IDE choose the board “Arduino Uno”, then Tools, Burn Bootloader"
        )


def _greet(line: serial.Serial) -> bool:
    end = time.monotonic() + PATIENCE
    received = b""
    while time.monotonic() < end:
        line.write(_GREETING)
        received += line.read(len(_GREETED))
        if _GREETED in received:
            return _falls_silent(line)
    return False


def _falls_silent(line: serial.Serial) -> bool:
    """Return True if the line falls silent in time; a program that sends by itself is no boot loader."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if not line.read(1):
            return True
    return False


def _ask(line: serial.Serial, question: bytes) -> int | None:
    end = time.monotonic() + PATIENCE
    received = b""
    line.write(question)
    while time.monotonic() < end:
        received += line.read(1)
        if answer := _VALUE.search(received):
            return answer[1][0]
    return None
