"""The search of the best variant by SciPy's differential evolution.

It needs no gradients, copes with noise and with variants that fail, tries a whole generation at once, and
repeats itself by its seed: so a resumed search finds its earlier runs stored. SciPy is what identification
needs already.
"""

from collections.abc import Callable, Iterator, Sequence
from importlib.util import find_spec
from queue import SimpleQueue
from threading import Thread
from typing import TypeVar

from robot_runtime.experiments.sweep.document import Sweep
from robot_runtime.experiments.sweep.parameter import Value

R = TypeVar("R")
DIGITS = 6
"""Significant digits of a value that is tried."""
NO_SCIPY = (
    "A search needs the package scipy, which is not installed. Install it where µ-CAT is installed, with "
    "“pip install scipy”, or take values instead of [search]."
)

Try = Callable[[int, Sequence[Sequence[Value | None]]], Iterator[R | list[float]]]
"""Yields the results of variants that are numbered from a first number on, at last their scores."""


def can_search() -> bool:
    """Return True where SciPy is installed."""
    return find_spec("scipy") is not None


def search_best(sweep: Sweep, try_variants: Try[R]) -> Iterator[R]:
    """Yield the results of the variants that are tried, generation by generation."""
    asked: SimpleQueue[list[list[float]] | BaseException | None] = SimpleQueue()
    answered: SimpleQueue[list[float] | None] = SimpleQueue()

    # SciPy calls, and is not called: it runs in a thread, so that results come out as they are done.
    def evolve() -> None:
        try:
            _evolve(sweep, asked, answered)
        except _StoppedError:
            pass
        except BaseException as problem:
            asked.put(problem)
        else:
            asked.put(None)

    thread = Thread(target=evolve, name="search", daemon=True)
    thread.start()
    first = 1
    try:
        while (generation := asked.get()) is not None:
            if isinstance(generation, BaseException):
                raise generation
            variants = [_complete(sweep, values) for values in generation]
            for result in try_variants(first, variants):
                if isinstance(result, list):
                    answered.put(result)
                else:
                    yield result
            first += len(variants)
    finally:
        answered.put(None)
        thread.join()


class _StoppedError(Exception):
    """Nobody takes the results any more."""


def _evolve(
    sweep: Sweep,
    asked: "SimpleQueue[list[list[float]] | BaseException | None]",
    answered: "SimpleQueue[list[float] | None]",
) -> None:
    from scipy.optimize import differential_evolution

    assert sweep.search is not None

    def in_parallel(_: object, population: Sequence[Sequence[float]]) -> list[float]:
        asked.put([[float(f"{value:.{DIGITS}g}") for value in variant] for variant in population])
        scores = answered.get()
        if scores is None:
            raise _StoppedError
        return scores

    limits = [(entry.low, entry.high) for entry in sweep.parameters if entry.kind == "search"]
    differential_evolution(
        _never_called,
        limits,
        popsize=sweep.generation // len(limits),
        maxiter=sweep.variants // sweep.generation - 1,
        tol=0.0,
        atol=0.0,
        polish=False,
        updating="deferred",
        workers=in_parallel,
        rng=sweep.search.seed,
    )


def _never_called(_: object) -> float:
    raise AssertionError


def _complete(sweep: Sweep, values: Sequence[float]) -> list[Value | None]:
    """Return the value of each parameter; None where the seed draws it."""
    searched = iter(values)
    complete: list[Value | None] = []
    for parameter in sweep.parameters:
        if parameter.kind == "search":
            complete.append(min(max(next(searched), parameter.low), parameter.high))
        else:
            complete.append(None)
    return complete
