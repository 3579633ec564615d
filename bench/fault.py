"""Longest times in ms until a fault of robot or chip is noticed and the fins stop, in simulated time."""

from tests.proofs import faults, injections

_TIMES = 5


def measure() -> dict[str, float]:
    """Measure some injections of each fault; `make faults` does a hundred."""
    return injections.figures(faults.measure_all(_TIMES, seed=1), ())
