"""`python -m bench.measurement PART FILE`: measures a part in a process of its own; writes it to a file."""

import importlib
import json
import subprocess
import sys
import tempfile
import time
import traceback
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.calibration import Slowness, mean, measure_slowness
from bench.parts import PARTS, BenchPart

_LOGS = Path("build/bench_logs")


class MeasurementError(Exception):
    """The part could not be measured; the text has the reason, and the path of its process's output."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """The figures of a part, how slow the machine was meanwhile, and the s that it took."""

    values: dict[str, float]
    slowness: Slowness
    took: float


def measure(part: BenchPart) -> Measurement:
    """Measure in another process, which leaves nothing to the next. Raise MeasurementError."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "figures.json"
        command = [sys.executable, "-m", "bench.measurement", part.name, str(file)]
        _LOGS.mkdir(parents=True, exist_ok=True)
        log = _LOGS / f"{part.name}.log"
        with log.open("w") as output:
            ended = subprocess.run(command, stdout=output, stderr=subprocess.STDOUT, check=False)
        if ended.returncode != 0:
            last = next(reversed(log.read_text().splitlines()), f"status {ended.returncode}")
            raise MeasurementError(f"{last} (see {log})")
        return Measurement(**json.loads(file.read_text()))


def _measure_here(part: BenchPart) -> Measurement:
    began = time.monotonic()
    before = {} if part.is_emulated else measure_slowness(part.draws)
    values = importlib.import_module(f"bench.{part.name}").measure()
    slowness = mean(before, {} if part.is_emulated else measure_slowness(part.draws))
    return Measurement(values, slowness, time.monotonic() - began)


def main() -> None:
    name, file = sys.argv[1:]
    try:
        measured = _measure_here(PARTS[name])
    except Exception as problem:
        traceback.print_exc()
        print(type(problem).__name__, *str(problem).splitlines()[:1], sep=": ")
        sys.exit(1)
    Path(file).write_text(json.dumps(asdict(measured)))


if __name__ == "__main__":
    main()
