"""Fixtures of the firmware's tests: the firmware compiled for this computer, and a whole robot of it."""

import ctypes
from collections.abc import Iterator

import pytest

from tests.firmware import library
from tests.firmware.robot import CompiledRobot


@pytest.fixture(scope="session")
def firmware() -> ctypes.CDLL:
    """The firmware's parts by their C names."""
    library.build()
    return library.load()


@pytest.fixture
def robot(firmware: ctypes.CDLL) -> Iterator[CompiledRobot]:
    """A robot that has just been switched on, on a new board whose devices all work."""
    with CompiledRobot(firmware) as robot:
        yield robot
