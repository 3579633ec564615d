"""The engine: runs are the same wherever they are computed, and none is lost or computed twice."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, Future
from contextlib import closing
from dataclasses import replace
from math import nan
from typing import Any

import pytest

from robot_runtime.experiments.scenario.boards import BUILD
from server.features.sweeps.engine import RunResult, SweepEngine
from server.features.sweeps.executors import ENDED, LocalWorkers
from server.features.sweeps.run_task import RunOutcome, RunTask, identify
from server.features.sweeps.simulation import simulate
from tests.server.features.sweeps.sweep_rig import EIGHT, HEAD, read, tasks_of, without_seconds


class InlineWorkers:
    """An executor in this process, which counts what it computes; `fail` breaks it at some runs."""

    count = 1
    alone = True

    def __init__(self, fail: Sequence[type[BaseException] | None] = ()) -> None:
        self.computed: list[str] = []
        self.opened = 0
        self.fail = list(fail)

    def open(self) -> Executor:
        self.opened += 1
        return _Inline(self)

    def close(self) -> None:
        pass


class _Inline(Executor):
    def __init__(self, workers: InlineWorkers) -> None:
        self._workers = workers

    def submit(self, _function: Any, task: Any, /, *_: Any, **__: Any) -> Future[Any]:  # type: ignore[override]
        future: Future[RunOutcome] = Future()
        problem = self._workers.fail.pop(0) if self._workers.fail else None
        if problem is not None:
            future.set_exception(problem("lost"))
        else:
            self._workers.computed.append(task.key)
            future.set_result(_quick(task))
        return future


def _quick(task: RunTask) -> RunOutcome:
    """Return what a run might give: its error is the distance of its gains from 2 and 1."""
    gains = task.table["control"]["gains"]["pid"]
    error = (gains["kp"] - 2) ** 2 + (gains["kd"] - 1) ** 2 + 0.001 * task.table["seed"]
    return RunOutcome(
        key=task.key, problem="", simulated=12.0, seconds=0.1, figures={"rmse": error}, words={}
    )


def perform(
    text: str, workers: InlineWorkers, stored: dict[str, RunOutcome] | None = None
) -> list[RunResult]:
    there = stored or {}
    engine = SweepEngine(
        read(text),
        "",
        identify(BUILD),
        lambda keys: {key: there[key] for key in keys if key in there},
        workers,
    )
    return [*engine.perform()]


def test_each_run_is_computed_once_and_stored_ones_never() -> None:
    workers = InlineWorkers()
    results = perform(EIGHT, workers)
    assert sorted(result.run.number for result in results) == [*range(1, 9)]
    assert len({*workers.computed}) == 8
    stored = {result.outcome.key: result.outcome for result in results[:5]}
    again = InlineWorkers()
    resumed = perform(EIGHT, again, stored)
    assert sum(result.stored for result in resumed) == 5
    assert len(again.computed) == 3
    none = InlineWorkers()
    perform(EIGHT, none, {result.outcome.key: result.outcome for result in results})
    # Where all is stored no process is started.
    assert none.opened == 0


def test_a_broken_pool_loses_nothing() -> None:
    from concurrent.futures.process import BrokenProcessPool

    workers = InlineWorkers([None, BrokenProcessPool, None, None, BrokenProcessPool])
    results = perform(EIGHT, workers)
    assert sorted(result.run.number for result in results) == [*range(1, 9)]
    assert not any(result.outcome.problem for result in results)
    assert workers.opened > 1


def test_a_run_that_always_ends_its_process_is_named_and_the_others_go_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from concurrent.futures.process import BrokenProcessPool

    deadly = tasks_of(read())[2][1].key

    def submit(_self: _Inline, _function: object, task: RunTask, /) -> Future[RunOutcome]:
        future: Future[RunOutcome] = Future()
        if task.key == deadly:
            future.set_exception(BrokenProcessPool("ended"))
        else:
            future.set_result(_quick(task))
        return future

    monkeypatch.setattr(_Inline, "submit", submit)
    results = perform(EIGHT, InlineWorkers())
    failed = {result.run.number: result.outcome for result in results if result.outcome.problem}
    assert [*failed] == [3]
    assert failed[3].problem == ENDED
    assert not failed[3].lasting
    assert len(results) == 8


WRONG: dict[str, dict[str, Any]] = {
    "ValueError: the worker sent the figures of another run": {"key": "other"},
    "ValueError: the worker sent figures that are no numbers": {"figures": {"rmse": nan}},
    "TypeError: must be real number, not str": {"figures": {"rmse": "0.1"}},
    "ValueError: the worker sent reasons that are no texts": {"words": {"rmse": 1}},
}


@pytest.mark.parametrize("problem", WRONG)
def test_what_no_worker_would_send_is_refused(problem: str, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = tasks_of(read())[2][1].key

    def submit(_self: _Inline, _function: object, task: RunTask, /) -> Future[RunOutcome]:
        future: Future[RunOutcome] = Future()
        future.set_result(replace(_quick(task), **(WRONG[problem] if task.key == wrong else {})))
        return future

    monkeypatch.setattr(_Inline, "submit", submit)
    results = perform(EIGHT, InlineWorkers())
    failed = [result.outcome for result in results if result.outcome.problem]
    assert [(outcome.key, outcome.problem, outcome.lasting) for outcome in failed] == [
        (wrong, problem, False)
    ]
    assert len(results) == 8


SEARCH = f"""{HEAD}seeds = 2
[search]
variants = 60
[vary]
"control.gains.pid.kp" = {{ from = 0.5, to = 8.0 }}
"control.gains.pid.kd" = {{ from = 0.5, to = 8.0 }}
"""


def test_a_search_finds_the_best_and_repeats_itself() -> None:
    workers = InlineWorkers()
    results = perform(SEARCH, workers)
    assert len(results) == 120
    best = min(results, key=lambda result: result.outcome.figures["rmse"] or 0)
    assert best.run.values == pytest.approx((2, 1), abs=0.5)
    stored = {result.outcome.key: result.outcome for result in results}
    again = InlineWorkers()
    resumed = perform(SEARCH, again, stored)
    assert again.computed == []
    resumed_runs, first_runs = (
        {result.run.number: result.run for result in some} for some in (resumed, results)
    )
    assert resumed_runs == first_runs


def test_a_search_that_is_given_up_ends() -> None:
    engine = SweepEngine(read(SEARCH), "", identify(BUILD), lambda _: {}, InlineWorkers())
    results: Iterator[RunResult] = engine.perform()
    next(results)
    results.close()  # type: ignore[attr-defined]


def test_a_killed_process_loses_nothing_and_bits_are_those_of_this_process() -> None:
    sweep = read()
    expected = {task.key: without_seconds(simulate(task)) for _, task in tasks_of(sweep)}
    with closing(LocalWorkers(2)) as workers:
        engine = SweepEngine(sweep, "", identify(BUILD), lambda _: {}, workers)
        results: list[RunResult] = []
        for result in engine.perform():
            results.append(result)
            if len(results) == 1:
                assert workers._pool is not None
                os.kill(next(iter(workers._pool._processes)), signal.SIGKILL)
    assert sorted(result.run.number for result in results) == [*range(1, 9)]
    assert {result.outcome.key: without_seconds(result.outcome) for result in results} == expected
    # Other gains and other seeds swim otherwise.
    assert len({str(outcome[3]) for outcome in expected.values()}) == 8


def test_a_worker_whose_sweep_has_ended_meanwhile_ends() -> None:
    program = "from server.features.sweeps.simulation import start_worker; start_worker(1); print('computes')"
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert ended.stdout == ""
