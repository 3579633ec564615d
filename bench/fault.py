"""Longest times in ms until a fault is noticed, the fins stop, and a killed process is back."""

from tests.proofs import faults, injections, outages

_TIMES, _OUTAGES = 10, 3


def measure() -> dict[str, float]:
    """Some injections of each; `make faults` does a hundred."""
    measured = faults.measure_all(_TIMES, seed=1)
    outcomes = outages.measure(_OUTAGES, seed=1)
    return injections.figures(measured, outcomes)
