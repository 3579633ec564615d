"""Results of a sweep: its variants with their intervals, failures by reason, the best and the next."""

from collections import Counter
from collections.abc import Iterable, Sequence
from math import inf

from robot_runtime.experiments.sweep.document import Sweep
from robot_runtime.experiments.sweep.parameter import Value
from server.analysis.definitions import RUN_FIGURES
from server.features.sweeps.run_task import RunOutcome
from server.features.sweeps.schemas import (
    FailureCount,
    NextBest,
    RankedBest,
    SweepBest,
    SweepVariant,
)
from server.features.sweeps.store import StoredRun
from server.features.sweeps.variants import (
    find_failure,
    find_interval,
    is_better,
    keeps_limits,
    score_variant,
    size_of,
)

REASONS_MAX = 50
VARIANTS_SHOWN = 5000
"""The first of a sweep; the table has all."""


class SweepProgress:
    """The count of a sweep's runs and its best variant, run by run as they are done."""

    def __init__(self, sweep: Sweep) -> None:
        self.done = 0
        self.failed = 0
        self.best: SweepBest | None = None
        self._sweep = sweep
        self._score = inf
        self._open: dict[int, list[StoredRun]] = {}

    def add(self, run: StoredRun) -> None:
        """Take in a run."""
        figures = self._sweep.figures
        self.done += 1
        self.failed += bool(find_failure(figures.best, run.outcome))
        runs = self._open.setdefault(run.variant, [])
        runs.append(run)
        if len(runs) < len(self._sweep.seeds):
            return
        del self._open[run.variant]
        outcomes = [entry.outcome for entry in sorted(runs, key=lambda entry: entry.number)]
        score = score_variant(figures, outcomes)
        if is_better(score, self._score):
            self._score = score
            self.best = SweepBest(
                variant=run.variant,
                values=shown_values(self._sweep, run.values),
                mean=find_interval(_values(outcomes, figures.best)).mean,
            )


def shown_values(sweep: Sweep, values: Sequence[Value]) -> list[Value | None]:
    """Return the values of a variant; None where each seed draws its own."""
    return [
        None if parameter.by_seed else value
        for parameter, value in zip(sweep.parameters, values, strict=True)
    ]


def list_variants(sweep: Sweep, runs: Iterable[StoredRun]) -> list[SweepVariant]:
    """Return the first variants of these runs, which are in order, with their figures' intervals."""
    return [_describe(sweep, group) for group in _group(runs)[:VARIANTS_SHOWN]]


def count_failures(sweep: Sweep, runs: Iterable[StoredRun]) -> list[FailureCount]:
    """Return the reasons of failed runs, the most frequent first."""
    reasons = Counter(find_failure(sweep.figures.best, run.outcome) for run in runs)
    return [
        FailureCount(reason=reason, count=count)
        for reason, count in reasons.most_common(REASONS_MAX + 1)
        if reason
    ]


def rank(sweep: Sweep, runs: Iterable[StoredRun]) -> RankedBest | None:
    """Return the best variant of which all runs are done, and how far the next is; None without any."""
    figures = sweep.figures
    whole = [group for group in _group(runs) if len(group) == len(sweep.seeds)]
    scores = [(score_variant(figures, _outcomes(group)), group) for group in whole]
    ranked = sorted((entry for entry in scores if is_better(entry[0], inf)), key=lambda entry: entry[0])
    if not ranked:
        return None
    best = ranked[0][1]
    interval = find_interval(_values(_outcomes(best), figures.best))
    return RankedBest(
        variant=best[0].variant,
        mean=interval.mean,
        low=interval.low,
        high=interval.high,
        next=_compare(figures.best, best, ranked[1][1]) if len(ranked) > 1 else None,
    )


def _compare(name: str, best: Sequence[StoredRun], other: Sequence[StoredRun]) -> NextBest:
    sizes = [[size_of(name, value) for value in _values(_outcomes(group), name)] for group in (best, other)]
    difference = find_interval([there - here for here, there in zip(*sizes, strict=True)])
    return NextBest(
        variant=other[0].variant, difference=difference.mean, low=difference.low, high=difference.high
    )


def _group(runs: Iterable[StoredRun]) -> list[list[StoredRun]]:
    groups: dict[int, list[StoredRun]] = {}
    for run in runs:
        groups.setdefault(run.variant, []).append(run)
    return [*groups.values()]


def _describe(sweep: Sweep, runs: Sequence[StoredRun]) -> SweepVariant:
    figures = sweep.figures
    outcomes = _outcomes(runs)
    there = {meaning.name: _values(outcomes, meaning.name) for meaning in RUN_FIGURES}
    return SweepVariant(
        number=runs[0].variant,
        values=shown_values(sweep, runs[0].values),
        runs=len(runs),
        failed=sum(bool(find_failure(figures.best, outcome)) for outcome in outcomes),
        within=keeps_limits(figures, outcomes),
        figures={name: find_interval(values) for name, values in there.items() if values},
    )


def _outcomes(runs: Iterable[StoredRun]) -> list[RunOutcome]:
    return [run.outcome for run in runs]


def _values(outcomes: Iterable[RunOutcome], name: str) -> list[float]:
    return [value for outcome in outcomes if (value := outcome.figures.get(name)) is not None]
