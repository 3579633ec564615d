"""A builder with a lasting folder, and boards in emulated time."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from robot_runtime.experiments.comm_test.builder import Builder
from robot_runtime.experiments.comm_test.document import CommTest
from robot_runtime.experiments.comm_test.results import CellResult
from robot_runtime.experiments.comm_test.runner import Runner
from tests.board.rig import PROGRAM, ROOT, build

Run = Callable[..., list[CellResult]]


def make_test(**changes: Any) -> CommTest:
    """Return a cell of the thesis's grid, with these changes."""
    values: dict[str, Any] = {
        "id": 1,
        "name": "tested",
        "ino_path": "comm_test/comm_test.ino",
        "delay": (0.0,),
        "baud_rate": (115200,),
        "from_val": 1,
        "to_val": 101,
        "expected": 100,
        "arduinodelay": (0.0,),
    }
    return CommTest(**values | changes)


@pytest.fixture(scope="session")
def builder() -> Builder:
    return Builder(ROOT / "build/comm_test")


@pytest.fixture(scope="session")
def program() -> Path:
    build(ROOT / "firmware/emulator")
    build(ROOT / "firmware/bootloader")
    return PROGRAM


@pytest.fixture
def run(builder: Builder, program: Path) -> Run:
    """Run the cells of a test that differs in these entries from one cell of the thesis's grid."""
    return lambda **changes: list(Runner(builder, program, 2).run(make_test(**changes)))
