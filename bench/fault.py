"""Longest times in ms until a fault of robot or chip is noticed and the fins stop, in simulated time."""

from tests.proofs import faults, injections

_TIMES = 5


def measure() -> dict[str, float]:
    """Some injections of each; `make faults` does a hundred."""
    return injections.figures(faults.measure_all(_TIMES, seed=1), ())
