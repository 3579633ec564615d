"""Latencies of cards and of motions."""

import numpy as np
import pytest

from server.metrics.card_response import card_latencies, motion_latency
from server.metrics.series import Series


def test_a_card_is_answered_by_the_next_set_point_unless_another_card_comes_first() -> None:
    assert card_latencies([1.0, 5.0, 5.2, 9.0], [1.3, 5.5, 20.0], end=12.0) == [
        pytest.approx(0.3),
        None,
        pytest.approx(0.3),
        None,
    ]


def test_motion_counts_from_where_the_hull_turned_round() -> None:
    times = np.arange(0.0, 10.0, 0.01)
    # It still rises until 2 s, and sinks from then on, by 0.1 m/s.
    depth = Series(times, 1.0 + 0.1 * np.abs(times - 2.0))
    assert motion_latency(depth, 1.0, 10.0, set_point=3.0) == pytest.approx(1.3, abs=0.011)
    assert motion_latency(depth, 1.0, 2.25, set_point=3.0) is None
    assert motion_latency(depth, 0.5, 10.0, set_point=0.0) == pytest.approx(0.3, abs=0.011)
    assert motion_latency(depth, 20.0, 30.0, set_point=0.0) is None
