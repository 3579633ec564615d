"""Statistics of variants: means with intervals, the best, and its paired difference to the next."""

from collections.abc import Sequence
from math import fsum, inf, isfinite, pi, sqrt, tan
from statistics import NormalDist, fmean, stdev

from robot_runtime.experiments.sweep.document import SweepFigures
from server.analysis.definitions import RUN_FIGURES
from server.features.sweeps.run_task import RunOutcome
from server.features.sweeps.schemas import FigureInterval

SHARE = 0.95
_BETTER = {meaning.name: meaning.better for meaning in RUN_FIGURES}
_TITLES = {meaning.name: meaning.title for meaning in RUN_FIGURES}


def find_interval(values: Sequence[float]) -> FigureInterval:
    """Return the mean with its 95 % interval, by Student's distribution; one value alone has none."""
    count = len(values)
    mean = fmean(values)
    if count < 2:
        return FigureInterval(mean=mean, low=None, high=None, count=count)
    half = student_quantile(count - 1) * stdev(values) / sqrt(count)
    return FigureInterval(mean=mean, low=mean - half, high=mean + half, count=count)


def student_quantile(freedom: int, share: float = SHARE) -> float:
    """Return the half width of Student's distribution that holds this share.

    For 1 and 2 degrees of freedom exact; else the expansion of Abramowitz and Stegun 26.7.5, to 0.1 %.
    """
    upper = (1 + share) / 2
    if freedom == 1:
        return tan(pi * (upper - 0.5))
    if freedom == 2:
        return (2 * upper - 1) * sqrt(2 / (4 * upper * (1 - upper)))
    z = NormalDist().inv_cdf(upper)
    terms = (
        z,
        (z**3 + z) / 4,
        (5 * z**5 + 16 * z**3 + 3 * z) / 96,
        (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / 384,
        (79 * z**9 + 776 * z**7 + 1482 * z**5 - 1920 * z**3 - 945 * z) / 92160,
    )
    return fsum(term / freedom**power for power, term in enumerate(terms))


def score_variant(figures: SweepFigures, outcomes: Sequence[RunOutcome]) -> float:
    """Return the score of a variant by its runs, less is better.

    It is infinite where a run failed or has no best figure, and beyond a limit.
    """
    if any(find_failure(figures.best, outcome) for outcome in outcomes):
        return inf
    if not keeps_limits(figures, outcomes):
        return inf
    return fmean(size_of(figures.best, value) for value in _values(outcomes, figures.best))


def size_of(name: str, value: float) -> float:
    """Return a value of a figure of which less is better: the distance from 0 where 0 is the best."""
    return abs(value) if _BETTER[name] == "zero" else value


def find_failure(best: str, outcome: RunOutcome) -> str:
    """Return why a run failed; one without the figure that ranks variants has failed, too."""
    if outcome.problem:
        return outcome.problem
    if outcome.figures.get(best) is not None:
        return ""
    return f"No {_TITLES[best]}. {outcome.words.get(best, '')}".strip()


def keeps_limits(figures: SweepFigures, outcomes: Sequence[RunOutcome]) -> bool:
    """Return True where the mean of each limited figure is within its limit."""
    for name, limit in figures.limits.items():
        values = _values(outcomes, name)
        if not values or fmean(values) > limit:
            return False
    return True


def is_better(score: float, than: float) -> bool:
    """Return True where a score is finite and less."""
    return isfinite(score) and score < than


def _values(outcomes: Sequence[RunOutcome], name: str) -> list[float]:
    return [value for outcome in outcomes if (value := outcome.figures.get(name)) is not None]
