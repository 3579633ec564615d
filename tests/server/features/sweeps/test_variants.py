"""Statistics of variants, beside SciPy's."""

import pytest
from scipy import stats

from robot_runtime.experiments.sweep.document import SweepFigures
from server.features.sweeps.results import SweepProgress, count_failures, list_variants, rank
from server.features.sweeps.run_task import RunOutcome
from server.features.sweeps.store import StoredRun
from server.features.sweeps.variants import find_interval, score_variant, student_quantile
from tests.server.features.sweeps.sweep_rig import EIGHT, read


@pytest.mark.parametrize("freedom", [1, 2, 3, 4, 9, 30, 999])
def test_the_quantile_is_that_of_student(freedom: int) -> None:
    assert student_quantile(freedom) == pytest.approx(stats.t.ppf(0.975, freedom), rel=1.5e-3)


def test_the_interval_is_that_of_the_mean() -> None:
    interval = find_interval([1.0, 2.0, 4.0])
    low, high = stats.t.interval(0.95, 2, 7 / 3, stats.sem([1.0, 2.0, 4.0]))
    assert (interval.mean, interval.count) == (pytest.approx(7 / 3), 3)
    assert (interval.low, interval.high) == (pytest.approx(low), pytest.approx(high))
    assert (find_interval([1.0]).low, find_interval([1.0]).high) == (None, None)


def run(number: int, rmse: float | None, problem: str = "", overshoot: float = 5.0) -> StoredRun:
    figures = {"rmse": rmse, "overshoot": overshoot}
    outcome = RunOutcome(
        key=str(number), problem=problem, simulated=1, seconds=1, figures=figures, words={"rmse": "Why."}
    )
    return StoredRun(number, (number + 1) // 2, 2 - number % 2, (1.5, float((number + 1) // 2)), outcome)


RUNS = [
    run(1, 0.5),
    run(2, 0.7),
    run(3, 0.4),
    run(4, 0.55),
    run(5, None),
    run(6, 0.1),
    run(7, 0.2, "It sank."),
]


def test_the_best_is_compared_by_equal_seeds() -> None:
    sweep = read(EIGHT)
    ranked = rank(sweep, RUNS)
    assert ranked is not None
    assert ranked.next is not None
    assert (ranked.variant, ranked.mean, ranked.next.variant) == (2, pytest.approx(0.475), 1)
    paired = find_interval([0.1, 0.15])
    assert (ranked.next.difference, ranked.next.low) == (
        pytest.approx(paired.mean),
        pytest.approx(paired.low),
    )


def test_variants_and_failures_are_counted() -> None:
    sweep = read(EIGHT)
    variants = list_variants(sweep, RUNS)
    assert [(entry.number, entry.runs, entry.failed) for entry in variants] == [
        (1, 2, 0),
        (2, 2, 0),
        (3, 2, 1),
        (4, 1, 1),
    ]
    assert variants[0].figures["rmse"].mean == pytest.approx(0.6)
    assert [(entry.reason, entry.count) for entry in count_failures(sweep, RUNS)] == [
        ("No RMSE. Why.", 1),
        ("It sank.", 1),
    ]
    progress = SweepProgress(sweep)
    for entry in RUNS:
        progress.add(entry)
    assert (progress.done, progress.failed) == (7, 2)
    assert progress.best is not None
    assert (progress.best.variant, progress.best.mean) == (2, pytest.approx(0.475))


def test_a_limit_takes_a_variant_out() -> None:
    figures = SweepFigures(limits={"overshoot": 6.0})
    assert score_variant(figures, [run(1, 0.5).outcome]) == 0.5
    assert score_variant(figures, [run(1, 0.5, overshoot=7.0).outcome]) == float("inf")
    assert (
        score_variant(
            SweepFigures(best="steady_error", limits={}),
            [
                RunOutcome(
                    key="", problem="", simulated=1, seconds=1, figures={"steady_error": -0.2}, words={}
                )
            ],
        )
        == 0.2
    )
