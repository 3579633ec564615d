"""Differences between sessions: the parameters in force while armed."""

import tomllib
from collections.abc import Callable
from typing import Any

import pytest

from server.analysis.differences import CHANGED, find_differences, flatten
from server.analysis.moments import ControlHistory, ParameterValues, Span
from server.platform.models import SessionRow


def history(*tuned: tuple[float, float], armed: tuple[Span, ...] = (Span(10, 20),)) -> ControlHistory:
    """Return a history of one parameter with these values from these times on."""
    parameters = tuple(
        ParameterValues(time, {"depth.pid.kp": kp, "vision.colour": "red", "loud": True})
        for time, kp in tuned
    )
    return ControlHistory(armed, armed_at_start=False, controls=(), state={}, parameters=parameters)


def differing(*histories: ControlHistory) -> dict[str, list[str]]:
    row = SessionRow(configuration="", scenario="")  # type: ignore[call-arg]
    differences = find_differences([(row, record) for record in histories])
    return {
        difference.name: difference.values for difference in differences if difference.group == "Parameters"
    }


def test_only_differing_parameters_are_listed() -> None:
    assert differing(history((0, 3)), history((0, 4))) == {"depth.pid.kp": ["3", "4"]}


def test_changes_while_armed_are_listed_in_order_and_others_are_not() -> None:
    record = history((0, 1), (5, 3), (12, 4), (25, 9))
    assert differing(record, history((0, 3))) == {"depth.pid.kp": [CHANGED + "3, 4", "3"]}


def test_a_session_that_was_never_armed_counts_with_its_initial_values() -> None:
    assert differing(history((0, 3), (5, 4), armed=()), history((0, 4), armed=())) == {
        "depth.pid.kp": ["3", "4"]
    }


def test_older_recordings_have_no_parameters() -> None:
    assert differing(history(), history((0, 3)))["loud"] == ["", "yes"]


@pytest.mark.parametrize("text", ["a" + ".a" * 20_000 + "=1", "a=" + "[" * 50_000])
def test_a_text_that_would_take_the_memory_is_not_read(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tomllib, "loads", loads_short_keys)
    ((name, message),) = flatten(text)
    assert (name, message.startswith("cannot be read: it ")) == ("text", True)


def loads_short_keys(text: str, loads: Callable[[str], dict[str, Any]] = tomllib.loads) -> dict[str, Any]:
    assert ".a" * 100 not in text
    return loads(text)
