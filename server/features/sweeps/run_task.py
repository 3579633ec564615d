"""A run of a sweep as a task, its outcome, and the key by which it is never computed twice."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from robot_runtime.experiments.sweep.document import Sweep, SweepRun
from robot_runtime.provenance import hash_firmware, hash_sources


@dataclass(frozen=True, slots=True, kw_only=True)
class RunTask:
    """A run to be computed: the scenario's table with its seed, and the range of its figures, s.

    `craft` is the text of the robot's craft file where the scenario has the robot's craft, else empty.
    """

    key: str
    table: Mapping[str, Any]
    craft: str
    start: float | None
    end: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOutcome:
    """The figures of a run, None where it has none, with the reason in `words`.

    `problem` says why the run failed; empty where it did not. `simulated` and `seconds` are the scenario's
    time and the time that it took, s. One that is not `lasting` failed by its worker, and may be tried again.
    """

    key: str
    problem: str
    simulated: float
    seconds: float
    figures: dict[str, float | None]
    words: dict[str, str]
    lasting: bool = True


@dataclass(frozen=True, slots=True)
class WorkerIdentity:
    """The origin of a run's bits beside its task: firmware, software, and a computer's arithmetic.

    `bits` is the hash of a probe's samples.
    """

    firmware: str
    software: str
    bits: str = ""


@cache
def identify(build: Path) -> WorkerIdentity:
    """Return what this computer computes with, without a probe's bits. Raise OSError.

    `build` is the folder of the firmware for this computer.
    """
    server = Path(__file__).parents[2]
    # All that figures follow from.
    sources = (
        server.parent / "robot_runtime",
        *(server / name for name in ("analysis", "library", "metrics")),
    )
    return WorkerIdentity(hash_firmware(build / "libhost_board.so"), hash_sources(*sources))


def find_key(task: Mapping[str, Any], identity: WorkerIdentity) -> str:
    """Return the key of a run: the hash of everything that its figures follow from."""
    content = json.dumps([task, identity.firmware, identity.software], sort_keys=True, default=str)
    return sha256(content.encode()).hexdigest()


def plan_task(sweep: Sweep, run: SweepRun, craft: str, identity: WorkerIdentity) -> RunTask:
    """Return the task of a run; `craft` is the text of the robot's craft file.

    Raise ConfigError where the scenario cannot be written.
    """
    table = sweep.scenario_of(run)
    figures = sweep.figures
    known = craft if table.get("craft") == "robot" else ""
    # Texts for a person change nothing.
    content = {name: value for name, value in table.items() if name not in ("title", "description")}
    what = {"scenario": content, "craft": known, "from": figures.start, "to": figures.end}
    return RunTask(
        key=find_key(what, identity), table=table, craft=known, start=figures.start, end=figures.end
    )
