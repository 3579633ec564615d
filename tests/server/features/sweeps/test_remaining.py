"""The remaining time of a sweep."""

from server.features.sweeps.results import SweepProgress
from server.features.sweeps.runner import ActiveSweep
from tests.server.features.sweeps.sweep_rig import EIGHT, read


def test_the_first_run_tells_how_long_the_others_take() -> None:
    sweep = read(EIGHT)
    active = ActiveSweep(1, sweep, SweepProgress(sweep))
    assert active.remaining(100.0) is None
    active.workers, active.last = 2, 100.0
    active.progress.done = active.computed = 1
    active.seconds = 4.0
    assert active.remaining(100.0) == 14.0
    assert active.remaining(101.0) == 13.0
    # A run that takes longer than the others does not end them.
    assert active.remaining(500.0) == 12.0
    active.workers = 0
    assert active.remaining(101.0) is None
