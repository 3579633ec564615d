"""Programs for the emulated board, built once, and boards that run them."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.board.monitor import SerialMonitor
from tests.board.rig import ROOT, SKETCHES, BoardRig, build

Make = Callable[..., BoardRig]


@pytest.fixture(scope="session")
def built() -> None:
    build(ROOT / "firmware/emulator")
    build(ROOT / "firmware/bootloader")
    build(ROOT / "tests/board/sketches")


@pytest.fixture
def make_rig(built: None, tmp_path: Path) -> Iterator[Make]:  # noqa: ARG001 - it must be built first
    """Starts boards with a sketch of this name, and ends them with the test."""
    with ExitStack() as rigs:

        def make(sketch: str, *options: str, baud: int = 115200) -> BoardRig:
            return rigs.enter_context(BoardRig(SKETCHES / f"{sketch}.elf", tmp_path, *options, baud=baud))

        yield make


@pytest.fixture
def rig(make_rig: Make) -> BoardRig:
    """A board with the sketch that obeys the test."""
    return make_rig("monitor")


@pytest.fixture
def monitor(rig: BoardRig) -> SerialMonitor:
    """The test's side of that sketch, whose board has booted."""
    monitor = SerialMonitor(rig)
    monitor.boot()
    rig.board.run(0.05)  # for the encoders
    return monitor
