"""`python -m bench.samples [NAME...]`: runs the thesis's grid again and writes the runs that ship.

Needs the emulated board of `make firmware`. Takes a few minutes a run.
"""

import argparse
import json
import platform
import sys
import time
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from robot_runtime.experiments.comm_test.builder import SKETCHES
from robot_runtime.experiments.comm_test.document import CommTest, read_document
from robot_runtime.experiments.comm_test.framings import FramingName
from robot_runtime.experiments.comm_test.lab import EmulatedLab
from robot_runtime.experiments.comm_test.line import Cancellation
from robot_runtime.experiments.comm_test.results import Direction
from server import VERSION

FOLDER = Path("server/features/comm_tests/samples")
BUILD = Path("build")
SAMPLES: dict[str, tuple[FramingName, Direction, str]] = {
    "grid-thesis": ("thesis", "to_board", "The thesis's grid, its own packets"),
    "grid-plain": ("plain", "to_board", "The thesis's grid, plain numbers"),
    "grid-robot": ("robot", "to_board", "The thesis's grid, the robot's link"),
    "grid-robot-to-host": ("robot", "to_host", "The thesis's grid, the robot's link, from the Arduino"),
    "grid-robot-both": ("robot", "both", "The thesis's grid, the robot's link, both ways at once"),
}


def main() -> int:
    """Run the tests. Return the exit status 0 once all requested runs are written."""
    parser = argparse.ArgumentParser(prog="python -m bench.samples", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"one of {', '.join(SAMPLES)}; all without")
    names = parser.parse_args().names
    unknown = [name for name in names if name not in SAMPLES]
    if unknown:
        parser.error(f"no sample {', '.join(unknown)}; there are {', '.join(SAMPLES)}")
    lab = EmulatedLab(BUILD, Cancellation())
    for name in names or SAMPLES:
        began = time.monotonic()
        run = _run(name, lab)
        _write(FOLDER / f"{name}.json", run)
        rates = [cell["rate"] for cell in run["cells"]]
        took = time.monotonic() - began
        print(
            f"{name}: {len(rates)} cells, rates {min(rates):.2f} to {max(rates):.2f}, {took:.0f} s",
            file=sys.stderr,
            flush=True,
        )
    return 0


def _run(name: str, lab: EmulatedLab) -> dict[str, Any]:
    framing, direction, title = SAMPLES[name]
    (thesis,) = read_document((SKETCHES / "comm_test/figure10.json").read_text(encoding="utf-8"))
    test: CommTest = replace(thesis, name=title, framing=framing, direction=direction)
    firmware, tools, _host = lab.prepare()
    started = time.time()
    results = lab.run(test, lambda _number, _phase: None)
    cells = [{"number": number, **result.values} for number, result in enumerate(results)]
    return {
        "name": title,
        "document": asdict(test),
        "framing": framing,
        "direction": direction,
        "cells": cells,
        "firmware": firmware,
        "tools": tools | {"mucat": VERSION, "python": platform.python_version()},
        "host": "emulated board",
        "started": started,
        "ended": time.time(),
        "place": "emulated",
        "state": "complete",
        "problem": "",
        "sample": name,
    }


def _write(path: Path, run: dict[str, Any]) -> None:
    """Write a line for each cell, since people compare them."""
    cells = ",\n".join("  " + json.dumps(cell, ensure_ascii=False) for cell in run["cells"])
    head = json.dumps({**run, "cells": []}, indent=1, ensure_ascii=False)
    path.write_text(head.replace('"cells": []', f'"cells": [\n{cells}\n ]') + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
