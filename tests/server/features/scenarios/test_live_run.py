"""The state that a scenario on the running robot takes for the one of before."""

import asyncio
from collections.abc import Iterator
from typing import Any, cast

import pytest

from robot_runtime.clock import SimulatedClock
from robot_runtime.errors import RefusedError
from server.features.scenarios import live_run
from server.features.scenarios.live_run import LiveExecutor
from server.platform.settings import Settings


class Monitor:
    """Returns these states one after the other, and then the last of them."""

    def __init__(self, *states: dict[str, Any] | None) -> None:
        self._states: Iterator[dict[str, Any] | None] = iter(states)
        self._newest: dict[str, Any] | None = None

    def state(self) -> dict[str, Any] | None:
        self._newest = next(self._states, self._newest)
        return self._newest


def executor(settings: Settings, monitor: Monitor) -> LiveExecutor:
    nobody = cast(Any, None)
    clock = SimulatedClock(100.0)
    return LiveExecutor(
        settings, nobody, nobody, nobody, nobody, cast(Any, monitor), nobody, clock, notify=nobody
    )


def test_a_state_from_before_the_start_may_lack_the_last_change_and_is_not_taken(settings: Settings) -> None:
    before, after = {"time": 99.9, "set_point_default": 0.3}, {"time": 100.1, "set_point_default": 0.9}
    live = executor(settings, Monitor(None, before, before, after))
    assert asyncio.run(live._next_state()) == after


def test_a_runtime_that_does_not_tell_its_state_is_an_error_in_words(
    settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live_run, "STATE_SECONDS", 0.01)
    live = executor(settings, Monitor({"time": 99.9}))
    with pytest.raises(RefusedError, match="does not tell its state"):
        asyncio.run(live._next_state())
