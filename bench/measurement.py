"""`python -m bench.measurement PART FILE`: measures a part in a process of its own; writes it to a file."""

import importlib
import json
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.calibration import Slowness, mean, measure_slowness
from bench.parts import PARTS, Part

_LINES_OF_FAILURE = 12


class MeasurementError(Exception):
    """The part could not be measured; the text ends with what its process said last."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """The figures of a part, how slow the machine was meanwhile, and the s that it took."""

    values: dict[str, float]
    slowness: Slowness
    took: float


def measure(part: Part) -> Measurement:
    """Measures in another process, which leaves nothing to the next. Raises MeasurementError."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "figures.json"
        command = [sys.executable, "-m", "bench.measurement", part.name, str(file)]
        ended = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
        )
        if ended.returncode != 0:
            said = "\n".join(ended.stdout.splitlines()[-_LINES_OF_FAILURE:])
            raise MeasurementError(f"status {ended.returncode}\n{said}")
        return Measurement(**json.loads(file.read_text()))


def _measure_here(part: Part) -> Measurement:
    began = time.monotonic()
    before = {} if part.is_emulated else measure_slowness(part.draws)
    values = importlib.import_module(f"bench.{part.name}").measure()
    slowness = mean(before, {} if part.is_emulated else measure_slowness(part.draws))
    return Measurement(values, slowness, time.monotonic() - began)


def main() -> None:
    name, file = sys.argv[1:]
    Path(file).write_text(json.dumps(asdict(_measure_here(PARTS[name]))))


if __name__ == "__main__":
    main()
