"""The engine of a sweep: it looks up the runs that are stored, and has the others computed."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

from robot_runtime.contract.limits import ConfigError
from robot_runtime.experiments.sweep.document import Sweep, SweepRun
from robot_runtime.experiments.sweep.parameter import Value
from server.features.sweeps.executors import RunPool, Workers
from server.features.sweeps.run_task import RunOutcome, RunTask, WorkerIdentity, find_key, plan_task
from server.features.sweeps.search import search_best
from server.features.sweeps.variants import score_variant

LOOKED_UP = 200
"""Runs that are looked up at once."""

Lookup = Callable[[Sequence[str]], Mapping[str, RunOutcome]]
"""Returns the stored outcomes among these keys."""


@dataclass(frozen=True, slots=True)
class RunResult:
    """A run that is done; `stored` where it was computed before."""

    run: SweepRun
    outcome: RunOutcome
    stored: bool


class SweepEngine:
    """The engine of one sweep; `perform` yields each run when it is done."""

    def __init__(
        self, sweep: Sweep, craft: str, identity: WorkerIdentity, stored: Lookup, workers: Workers
    ) -> None:
        self._sweep = sweep
        self._craft = craft
        self._identity = identity
        self._stored = stored
        self._workers = workers
        self._pool: RunPool | None = None

    def perform(self) -> Iterator[RunResult]:
        """Yield all runs, the stored ones at once, the others as they are done."""
        sweep = self._sweep
        if sweep.search is not None:
            yield from search_best(sweep, self._try)
            return
        grid = enumerate(sweep.grid(), 1)
        yield from self._compute(run for variant, values in grid for run in sweep.runs_of(variant, values))

    def _try(
        self, first: int, variants: Sequence[Sequence[Value | None]]
    ) -> Iterator[RunResult | list[float]]:
        """Yield the runs of these variants, numbered from `first` on, and at last their scores."""
        sweep = self._sweep
        done: dict[int, list[RunOutcome]] = {}
        runs = (
            run for variant, values in enumerate(variants, first) for run in sweep.runs_of(variant, values)
        )
        for result in self._compute(runs):
            done.setdefault(result.run.variant, []).append(result.outcome)
            yield result
        yield [score_variant(sweep.figures, done[variant]) for variant in range(first, first + len(variants))]

    def _compute(self, runs: Iterable[SweepRun]) -> Iterator[RunResult]:
        coming = self._look_up(iter(runs))
        flight: dict[str, list[SweepRun]] = {}
        exhausted = False
        while not exhausted or flight:
            while not exhausted and (self._pool is None or self._pool.free):
                entry = next(coming, None)
                if entry is None:
                    exhausted = True
                    break
                run, task, outcome = entry
                if outcome is not None or task is None:
                    assert outcome is not None
                    yield RunResult(run, outcome, stored=True)
                elif task.key in flight:
                    flight[task.key].append(run)
                else:
                    flight[task.key] = [run]
                    if self._pool is None:
                        # Only now: where all is stored, no process is started.
                        self._pool = RunPool(self._workers)
                    self._pool.submit(task)
            if self._pool is not None and flight:
                for outcome in self._pool.take():
                    for run in flight.pop(outcome.key):
                        yield RunResult(run, outcome, stored=False)

    def _look_up(
        self, runs: Iterator[SweepRun]
    ) -> Iterator[tuple[SweepRun, RunTask | None, RunOutcome | None]]:
        while batch := [*islice(runs, LOOKED_UP)]:
            planned = [(run, self._plan(run)) for run in batch]
            stored = self._stored([task.key for _, task in planned if isinstance(task, RunTask)])
            for run, task in planned:
                if isinstance(task, RunTask):
                    yield run, task, stored.get(task.key)
                else:
                    yield run, None, task

    def _plan(self, run: SweepRun) -> RunTask | RunOutcome:
        try:
            return plan_task(self._sweep, run, self._craft, self._identity)
        except ConfigError as problem:
            text = " ".join(problem.texts)
            key = find_key({"sweep": self._sweep.name, "values": run.values, "problem": text}, self._identity)
            return RunOutcome(key=key, problem=text, simulated=0.0, seconds=0.0, figures={}, words={})
