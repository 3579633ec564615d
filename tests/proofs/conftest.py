"""The firmware compiled for this computer."""

import ctypes

import pytest

from tests.firmware import library


@pytest.fixture(scope="session")
def firmware() -> ctypes.CDLL:
    """The firmware's parts by their C names."""
    library.build()
    return library.load()
