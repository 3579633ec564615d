"""The measured figures in build/bench.json, each with its date, commit, machine and calibration."""

import json
import platform
import subprocess
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from bench.calibration import Slowness

FILE = Path("build/bench.json")
CONTROLLERS = Path("docs/develop/controllers.md")
STORED = (CONTROLLERS, Path("docs/develop/proofs.md"), Path("tests/proofs/results.json"))
"""What proofs store in the repository."""


@dataclass(frozen=True, slots=True)
class MeasuredFigure:
    """A measured value."""

    value: float
    part: str
    measured: str
    """ISO 8601, UTC."""
    commit: str
    """Ends in `+` where files differed from it."""
    machine: str
    slowness: Slowness


@dataclass(frozen=True, slots=True)
class Failure:
    """A part that could not be measured."""

    reason: str
    measured: str
    commit: str


class Results:
    """All figures that were measured last, and the parts without any; each change is written at once."""

    def __init__(self, file: Path = FILE) -> None:
        """Read the file. One of another form counts as empty."""
        stored = json.loads(file.read_text()) if file.exists() else {}
        self._file = file
        self._commit, self._machine = commit(), machine()
        self.figures: dict[str, MeasuredFigure] = {}
        self.failures: dict[str, Failure] = {}
        if {"figures", "failures"} <= stored.keys():
            self.figures = {name: MeasuredFigure(**values) for name, values in stored["figures"].items()}
            self.failures = {part: Failure(**values) for part, values in stored["failures"].items()}

    def add(self, part: str, values: Mapping[str, float], slowness: Slowness) -> None:
        """Replace the figures of this part."""
        self._forget(part)
        now = _now()
        self.figures |= {
            name: MeasuredFigure(value, part, now, self._commit, self._machine, slowness)
            for name, value in values.items()
        }
        self._write()

    def fail(self, part: str, reason: str) -> None:
        """Remove the figures of this part, which has none now."""
        self._forget(part)
        self.failures[part] = Failure(reason, _now(), self._commit)
        self._write()

    def _forget(self, part: str) -> None:
        self.failures.pop(part, None)
        self.figures = {name: figure for name, figure in self.figures.items() if figure.part != part}

    def _write(self) -> None:
        whole: dict[str, Any] = {
            "figures": {name: asdict(figure) for name, figure in sorted(self.figures.items())},
            "failures": {part: asdict(failure) for part, failure in sorted(self.failures.items())},
        }
        self._file.parent.mkdir(parents=True, exist_ok=True)
        self._file.write_text(json.dumps(whole, indent=2) + "\n")


def commit() -> str:
    """Return the commit of the working tree, with a `+` where a file other than what proofs store differs."""
    head = _git("rev-parse", "--short=10", "HEAD").stdout.strip()
    # A proof that stores its result would make all that was proven before it count as proven of other code.
    changed = (
        head
        and _git("diff", "--quiet", "HEAD", "--", ".", *(f":(exclude){path}" for path in STORED)).returncode
    )
    return (head or "unknown") + ("+" if changed else "")


def _git(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", *arguments], capture_output=True, text=True, check=False)


def machine() -> str:
    """Return the processor's name and the number of cores."""
    model = next(
        (line.partition(":")[2].strip() for line in _processor_lines() if line.startswith("model name")),
        platform.machine(),
    )
    cores = sum(line.startswith("processor") for line in _processor_lines())
    return f"{model}, {cores} cores"


def _processor_lines() -> list[str]:
    return Path("/proc/cpuinfo").read_text().splitlines()


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
