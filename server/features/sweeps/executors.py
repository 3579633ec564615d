"""Executors of runs: processes of this computer, or the workers of a scheduler of Dask; one code path.

Both give a `concurrent.futures.Executor`, and what is lost with a killed process is computed again.
"""

import multiprocessing
import os
from collections import deque
from collections.abc import Callable
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from math import isfinite
from typing import Protocol

from server.features.sweeps.run_task import RunOutcome, RunTask
from server.features.sweeps.simulation import simulate, start_worker

WAITING = 2
"""Tasks of each worker: one that it computes, and one that waits, so that it never does."""
WAIT_SECONDS = 2.0
"""Between two looks at whether workers have come or gone."""
ENDED = "The process that computed it was ended each time. The computer may lack memory."


class Workers(Protocol):
    """The workers of a sweep, and the executor in force."""

    @property
    def count(self) -> int:
        """The number of runs that are computed at once."""

    @property
    def alone(self) -> bool:
        """True where one run can take those of others with it: these are then tried one by one."""

    def open(self) -> Executor:
        """Return an executor; after the first call a new one in place of a broken one."""

    def close(self) -> None:
        """End it, with what it computes."""


class LocalWorkers:
    """Processes of this computer, niced, one thread each."""

    alone = True

    def __init__(self, count: int = 0) -> None:
        self.count = count or len(os.sched_getaffinity(0))
        self._pool: ProcessPoolExecutor | None = None

    def open(self) -> Executor:
        """Return a new pool of processes."""
        self.close()
        # Not forked: a process with threads cannot be.
        context = multiprocessing.get_context("spawn")
        self._pool = ProcessPoolExecutor(self.count, context, start_worker, (os.getpid(),))
        return self._pool

    def close(self) -> None:
        """End the pool."""
        if self._pool is not None:
            self._pool.shutdown(wait=False, cancel_futures=True)


class RunPool:
    """Runs under way at workers; none is lost with a worker, a pool or a scheduler."""

    def __init__(self, workers: Workers) -> None:
        self._workers = workers
        self._executor = workers.open()
        self._flight: dict[Future[RunOutcome], RunTask] = {}
        self._lost: deque[RunTask] = deque()
        """To be submitted again."""
        self._alone = False
        """The lost ones are tried one by one, to find the one that ends its worker."""

    @property
    def busy(self) -> bool:
        """True while a run is not done."""
        return bool(self._flight or self._lost)

    @property
    def free(self) -> bool:
        """True where another run can be submitted."""
        return not self._lost and not (self._alone and self._flight) and self._has_room()

    def submit(self, task: RunTask) -> None:
        """Have a run computed."""
        try:
            self._flight[self._executor.submit(simulate, task)] = task
        except (BrokenExecutor, RuntimeError):
            # It broke since: those under way say so, too.
            self._lost.append(task)
            if not self._flight:
                self._recover()

    def take(self) -> list[RunOutcome]:
        """Wait for runs and return those that are done; none after a while."""
        while self._lost and (not self._flight if self._alone else self._has_room()):
            task = self._lost.popleft()
            self.submit(task)
            if self._lost and self._lost[-1] is task:
                break
        done, _ = wait(self._flight, WAIT_SECONDS, FIRST_COMPLETED)
        outcomes, broken = [], False
        for future in done:
            task = self._flight.pop(future)
            try:
                outcomes.append(_check(task, future.result()))
            except (BrokenExecutor, CancelledError):
                broken = True
                if self._alone and not self._flight and len(done) == 1:
                    outcomes.append(_fail(task, ENDED))
                else:
                    self._lost.append(task)
            except Exception as problem:
                outcomes.append(_fail(task, f"{type(problem).__name__}: {problem}"))
        if broken:
            self._recover()
        elif not self._lost and not self._flight:
            self._alone = False
        return outcomes

    def _has_room(self) -> bool:
        return len(self._flight) < WAITING * max(self._workers.count, 1)

    def _recover(self) -> None:
        """Take back everything that is under way, and go on with a new executor."""
        self._lost.extendleft(reversed(self._flight.values()))
        self._flight.clear()
        self._alone = self._workers.alone
        self._executor = self._workers.open()


def _check(task: RunTask, outcome: object) -> RunOutcome:
    """Return an outcome that is one of this task. Raise ValueError for what a wrong worker may send."""
    if not isinstance(outcome, RunOutcome) or outcome.key != task.key:
        raise ValueError("the worker sent the figures of another run")
    values = [value for value in outcome.figures.values() if value is not None]
    if not all(isfinite(value) for value in (outcome.simulated, outcome.seconds, *values)):
        raise ValueError("the worker sent figures that are no numbers")
    if not all(
        isinstance(text, str) for text in (outcome.problem, *outcome.words.values(), *outcome.figures)
    ):
        raise ValueError("the worker sent reasons that are no texts")
    return outcome


def _fail(task: RunTask, problem: str) -> RunOutcome:
    return RunOutcome(
        key=task.key, problem=problem, simulated=0.0, seconds=0.0, figures={}, words={}, lasting=False
    )


Tell = Callable[[str], None]
"""Takes a sentence for a person."""
