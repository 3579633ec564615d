"""Sweeps: their overhead over the scenarios themselves, and the gain of a second worker; pool and Dask."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import ExitStack, contextmanager
from statistics import median
from tempfile import TemporaryDirectory

from robot_runtime.experiments.scenario.boards import BUILD, boards
from robot_runtime.experiments.scenario.document import read_scenario_table
from robot_runtime.experiments.scenario.library import shipped_scenarios
from robot_runtime.experiments.scenario.run import ScenarioRun, Unheard
from robot_runtime.experiments.sweep.document import Sweep
from server.features.sweeps.engine import SweepEngine
from server.features.sweeps.executors import LocalWorkers, Workers
from server.features.sweeps.order import reopen
from server.features.sweeps.run_task import RunTask, WorkerIdentity, identify, plan_task
from server.features.sweeps.simulation import probe

_TEXT = """
format = 1
name = "bench"
scenario = "hover_in_a_current"
seeds = 2
[vary]
"control.gains.pid.kp" = [1.5, 3.0, 4.5]
"control.gains.pid.kd" = [1.0, 2.0]
"""
_ROUNDS = 6
"""Of some 90 s. A single one scatters by 5 %."""


def measure() -> dict[str, float]:
    """Measure twelve runs of 60 s one by one, and as sweeps with one and two workers: medians of the rounds.

    Only neighbours in time are compared, since the computer's own speed changes by more than the goals.
    """
    sweep, identity = _read(), identify(BUILD)
    tasks = _plan(sweep, identity)
    _one_by_one(tasks[:1])

    def on_dask(count: int) -> float:
        with _cluster(count) as workers:
            return _sweep(sweep, identity, workers, count)

    sides: dict[str, Callable[[], float]] = {
        "double": lambda: _sweep(sweep, identity, LocalWorkers(2), 2),
        "single": lambda: _sweep(sweep, identity, LocalWorkers(1), 1),
        "alone": lambda: _one_by_one(tasks),
        "dask_one": lambda: on_dask(1),
        "dask_two": lambda: on_dask(2),
    }
    rounds = []
    for _ in range(_ROUNDS):
        rounds.append({name: measure_side() for name, measure_side in sides.items()})
        # Forth and back, so that a computer that grows steadily slower is no difference between the sides.
        sides = dict(reversed(sides.items()))

    def ratio(side: str, other: str) -> float:
        return median(seconds[side] / seconds[other] for seconds in rounds)

    return {
        "sweep.overhead_percent": 100 * (ratio("single", "alone") - 1),
        "sweep.speed_up_two_x": ratio("single", "double"),
        "sweep.dask_overhead_percent": 100 * (ratio("dask_one", "alone") - 1),
        "sweep.dask_speed_up_two_x": ratio("dask_one", "dask_two"),
    }


def _read() -> Sweep:
    text = shipped_scenarios()["hover_in_a_current"]
    return reopen(_TEXT, text)


def _plan(sweep: Sweep, identity: WorkerIdentity) -> list[RunTask]:
    return [
        plan_task(sweep, run, "", identity)
        for variant, values in enumerate(sweep.grid(), 1)
        for run in sweep.runs_of(variant, values)
    ]


def _one_by_one(tasks: list[RunTask]) -> float:
    """Return the s that these scenarios take by themselves, without any figures."""
    began = time.monotonic()
    for task in tasks:
        ScenarioRun(read_scenario_table(dict(task.table)), boards()["host"], Unheard()).perform(lambda _: {})
    return time.monotonic() - began


def _sweep(sweep: Sweep, identity: WorkerIdentity, workers: Workers, count: int) -> float:
    """Return the s that the sweep takes with so many workers that are there already."""
    ready = _ReadyWorkers(workers, count)
    began = time.monotonic()
    done = [*SweepEngine(sweep, "", identity, lambda _: {}, ready).perform()]
    seconds = time.monotonic() - began
    assert len(done) == sweep.runs
    ready.close()
    return seconds


class _ReadyWorkers:
    """Workers whose processes have loaded everything."""

    def __init__(self, workers: Workers, count: int) -> None:
        self._workers = workers
        self.alone = workers.alone
        self._executor = workers.open()
        while workers.count < count:
            time.sleep(0.1)
        there: set[int] = set()
        while len(there) < count:
            there |= {future.result() for future in [self._executor.submit(os.getpid) for _ in range(count)]}
        for future in [self._executor.submit(probe) for _ in range(count)]:
            future.result()

    @property
    def count(self) -> int:
        return self._workers.count

    def open(self) -> Executor:
        """Return the executor that is there."""
        return self._executor

    def close(self) -> None:
        """End it."""
        self._workers.close()


@contextmanager
def _cluster(count: int) -> Iterator[Workers]:
    """Yield a scheduler in this process, with workers as people start them."""
    from distributed import LocalCluster

    from server.features.sweeps.cluster import ClusterWorkers

    with (
        TemporaryDirectory(prefix="mucat-") as folder,
        LocalCluster(n_workers=0, dashboard_address=None) as cluster,
        ExitStack() as ended,
    ):
        address: str = cluster.scheduler_address
        for _ in range(count):
            command = [sys.executable, "-m", "server.cli", "worker", "--scheduler", address, "--data", folder]
            worker = subprocess.Popen(command, stdout=subprocess.DEVNULL)
            ended.callback(worker.wait)
            ended.callback(worker.kill)
        yield ClusterWorkers(address, "", identify(BUILD), lambda _: None)
