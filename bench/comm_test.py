"""The thesis's grid over the robot's own link, in each direction: 225 cells, 4.4 emulated hours."""

import os
from dataclasses import replace
from pathlib import Path
from typing import get_args

from robot_runtime.experiments.comm_test.builder import SKETCHES, Builder
from robot_runtime.experiments.comm_test.document import read_document
from robot_runtime.experiments.comm_test.results import Direction
from robot_runtime.experiments.comm_test.runner import Runner

_BUILD = Path("build")


def measure() -> dict[str, float]:
    """Return the least share of the numbers that arrived right, over all cells and directions."""
    (thesis,) = read_document((SKETCHES / "comm_test/figure10.json").read_text(encoding="utf-8"))
    runner = Runner(Builder(_BUILD / "comm_test"), _BUILD / "board", os.cpu_count() or 1)
    rates = [
        result.rate
        for direction in get_args(Direction)
        for result in runner.run(replace(thesis, framing="robot", direction=direction))
    ]
    return {"link.table6_min_success": min(rates)}
