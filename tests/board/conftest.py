"""Programs for the emulated board, built once, and boards that run them."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.board.rig import ROOT, SKETCHES, Rig, build

Make = Callable[..., Rig]


@pytest.fixture(scope="session")
def built() -> None:
    build(ROOT / "firmware/emulator")
    build(ROOT / "firmware/bootloader")
    build(ROOT / "tests/board/sketches")


@pytest.fixture
def make_rig(built: None, tmp_path: Path) -> Iterator[Make]:  # noqa: ARG001 - it must be built first
    """Starts boards with a sketch of this name, and ends them with the test."""
    with ExitStack() as rigs:

        def make(sketch: str, *options: str, baud: int = 115200) -> Rig:
            return rigs.enter_context(Rig(SKETCHES / f"{sketch}.elf", tmp_path, *options, baud=baud))

        yield make
