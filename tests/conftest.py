"""Hypothesis settings of all tests, and what the garbage collector passes over."""

import gc

from hypothesis import HealthCheck, settings

# A busy machine is slow, not wrong.
settings.register_profile("mucat", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("mucat")


def pytest_collection_finish() -> None:
    """Modules stay to the end: to examine them again and again would take a fifth of the processor time."""
    gc.collect()
    gc.freeze()
