"""Longest times in ms until the outage of a process is noticed, the fins stop, and all is well again."""

from tests.proofs import injections, outages

_TIMES = 2
"""Armed and disarmed."""


def measure() -> dict[str, float]:
    """Measure some outages of each process; `make faults` causes a hundred."""
    return injections.figures({}, outages.measure(_TIMES, seed=1))
