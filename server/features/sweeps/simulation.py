"""One run of a sweep: a scenario in simulated time, and its figures; nothing is recorded.

`simulate` is a pure function of its task, the firmware and the software: equal tasks give equal bits, in
whatever process of whatever computer. Workers call it; so nothing here belongs to a server.
"""

import gc
from functools import cache
from hashlib import sha256
from math import isfinite
from time import perf_counter
from typing import Any

import cv2

from robot_runtime.contract.craft import DEFAULT_DOCUMENT, read_craft
from robot_runtime.contract.limits import ConfigError
from robot_runtime.contract.packets.layout import LayoutError
from robot_runtime.contract.topics import MISSION
from robot_runtime.experiments.scenario.boards import BUILD, boards
from robot_runtime.experiments.scenario.document import read_scenario, read_scenario_table
from robot_runtime.experiments.scenario.run import ScenarioRun
from robot_runtime.link.link_driver import PortError
from robot_runtime.provenance import HASH_CHARACTERS
from robot_runtime.simulation.boards.emulator_process import BoardError
from robot_runtime.transport.lifetime import end_with_parent, give_way, limit_memory
from server.analysis.history import read_history
from server.analysis.run_figures import RunSamples, measure_run
from server.analysis.samples import Samples
from server.features.sweeps.run_task import RunOutcome, RunTask, WorkerIdentity, identify
from server.platform.errors import ApiError

NICENESS = 10
"""A robot in real time goes first."""
BYTES_MAX = 1_000_000_000
"""Of a worker's own memory."""
PROBE = """
name = "probe"
title = "Probe"
duration = 10
[scene]
kind = "natural"
depth = 4.0
[water.current]
north = 0.05
[control]
controller = "pid"
set_point = 0.6
[[events]]
at = 1
do = "arm"
[[events]]
at = 5
do = "waves"
amplitude = 0.05
period = 2.5
direction = 1.0
"""


def start_worker(parent: int) -> None:
    """Prepare a process of this computer for runs: niced, one thread, ended with its parent, this process."""
    # Which may have ended while this one was loading.
    end_with_parent(parent)
    settle_worker()


def settle_worker() -> None:
    """Prepare this process for runs: niced, with limited memory, one thread."""
    give_way(NICENESS)
    limit_memory(BYTES_MAX)
    cv2.setNumThreads(1)
    # What is loaded stays: the garbage collector need not look through it in each run.
    gc.collect()
    gc.freeze()


@cache
def probe() -> WorkerIdentity:
    """Return the same with a probe's bits, which takes half a second. Raise BoardError, OSError."""
    own = identify(BUILD)
    gathered = _Bits()
    scenario = read_scenario(PROBE)
    ScenarioRun(scenario, boards()["host"], gathered).perform(lambda _: {})
    return WorkerIdentity(own.firmware, own.software, gathered.hash.hexdigest()[:HASH_CHARACTERS])


def simulate(task: RunTask) -> RunOutcome:
    """Compute a run. What goes wrong with it is said in the outcome."""
    began = perf_counter()
    simulated = 0.0
    try:
        craft = read_craft(task.craft) if task.craft else DEFAULT_DOCUMENT
        scenario = read_scenario_table(dict(task.table), craft.craft)
        simulated = scenario.duration
        listener = _Listener()
        ScenarioRun(scenario, boards()["host"], listener, craft).perform(lambda _: {})
        problem, figures, reasons = listener.measure(task.start, task.end)
    except ConfigError as refused:
        problem, figures, reasons = " ".join(refused.texts), {}, {}
    except ApiError as failed:
        problem, figures, reasons = failed.detail, {}, {}
    except (BoardError, PortError, LayoutError) as failed:
        problem, figures, reasons = str(failed), {}, {}
    return RunOutcome(
        key=task.key,
        problem=problem,
        simulated=simulated,
        seconds=perf_counter() - began,
        figures=figures,
        words=reasons,
    )


class _Listener:
    """The receiver of a run's samples."""

    def __init__(self) -> None:
        self._samples = RunSamples()
        self._ended = 0.0
        self._remarks = ""

    def blocks(self, data: bytes) -> None:
        """Take in samples."""
        self._samples.add(data)

    def event(self, event: str, **more: Any) -> None:
        """Take in the run's end."""
        if event == "ended":
            self._ended, self._remarks = float(more["time"]), str(more["problem"] or "")

    def measure(
        self, start: float | None, end: float | None
    ) -> tuple[str, dict[str, float | None], dict[str, str]]:
        """Return the reason for a failure, the figures, and the reasons for missing ones."""
        recording = self._samples.record(self._ended)
        history = read_history(recording, Samples())
        figures = measure_run(recording, history, start, end)
        values = {
            name: figure.value if figure.value is not None and isfinite(figure.value) else None
            for name, figure in figures.items()
        }
        reasons = {name: figure.words for name, figure in figures.items() if values[name] is None}
        missions = [*recording.documents(MISSION.name)]
        problem = ""
        if not history.armed:
            problem = self._remarks or "The robot was never armed."
        elif missions and missions[-1]["phase"] == "failed":
            problem = f"The mission failed: {missions[-1]['text']}"
        return problem, values, reasons


class _Bits:
    """The hash of a run's samples."""

    def __init__(self) -> None:
        self.hash = sha256()

    def blocks(self, data: bytes) -> None:
        """Take in samples."""
        self.hash.update(data)

    def event(self, event: str, **more: Any) -> None:
        """Pass over events."""
