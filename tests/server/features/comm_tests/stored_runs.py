"""A run and a lost cell of a communication test, as the database stores them."""

from typing import Any

from robot_runtime.experiments.comm_test.results import CellResult, Counts, GridCell, LineErrors
from server.features.comm_tests.runs import CommTestStore
from tests.runtime.experiments.comm_test.conftest import make_test

ENTRY: dict[str, Any] = {
    "id": 1,
    "name": "two delays",
    "ino_path": "/micro_cat_test/arduino/test_6/test_6.ino",
    "delay": [0.0, 0.5],
    "baud_rate": [115200],
    "from_val": 1,
    "to_val": 13,
    "expected": 12,
    "arduinodelay": [0.1],
}


LOST = CellResult(GridCell(9600, 0.5, 1.0), "to_board", 100, None, Counts(), 0, 0, LineErrors(7, 0, 0), 3.0)


async def begin(runs: CommTestStore) -> int:
    return await runs.start(make_test(), "emulated", "firmware", {}, "host")
