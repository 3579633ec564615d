"""The registry: refusals, changes as a whole, and never half of a change at a control tick."""

import math
import threading
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.errors import RefusedError
from robot_runtime.parameters.entry import Entry
from robot_runtime.parameters.registry import Registry


class ParameterBox:
    """An object with parameters."""

    def __init__(self) -> None:
        self.armed = False
        self.tick_lock = threading.RLock()
        self.held: dict[str, Any] = {"a": 1.0, "b": 2.0, "count": 3, "kind": "x", "on": False, "rest": 0.0}
        self.registry = Registry(
            [
                self._number("a"),
                self._number("b"),
                self._number("rest", while_armed=False),
                Entry(name="count", type="whole", minimum=0, maximum=9, meaning="", **self._ways("count")),
                Entry(name="kind", type="choice", choices=lambda: "xy", meaning="", **self._ways("kind")),
                Entry(name="on", type="switch", meaning="", **self._ways("on")),
            ],
            armed=lambda: self.armed,
            tick_lock=self.tick_lock,
        )

    def _number(self, name: str, *, while_armed: bool = True) -> Entry:
        ways = self._ways(name)
        return Entry(name=name, minimum=-5, maximum=5, unit="m", meaning="", while_armed=while_armed, **ways)

    def _ways(self, name: str) -> dict[str, Any]:
        return {"get": lambda: self.held[name], "set": lambda value: self.held.update({name: value})}


@pytest.mark.parametrize(
    ("values", "why"),
    [
        ({"a": 5.1}, "a is 5.1; it must lie between -5 and 5 m"),
        ({"a": math.nan}, "a is nan; it must lie between"),
        ({"a": math.inf}, "a is inf; it must lie between"),
        ({"a": 10**400}, "a is too large; it must lie between"),
        ({"a": "1"}, "a is '1'; it must be a number"),
        ({"a": True}, "a is True; it must be a number"),
        ({"a": None}, "a is None; it must be a number"),
        ({"a": [1]}, "it must be a number"),
        ({"count": 1.0}, "count is 1.0; it must be a whole number"),
        ({"kind": "z"}, "kind is 'z'; it must be one of x, y"),
        ({"kind": 1}, "kind is 1; it must be a text"),
        ({"on": 1}, "on is 1; it must be true or false"),
        ({"nothing": 1}, "there is no parameter 'nothing'"),
    ],
)
def test_invalid_values_are_refused_and_nothing_is_set(values: dict[str, Any], why: str) -> None:
    box = ParameterBox()
    before = dict(box.held)
    with pytest.raises(RefusedError) as refused:
        box.registry.apply({"b": -1, **values})
    assert why in str(refused.value)
    assert str(refused.value).endswith("Nothing was changed.")
    assert box.held == before


def test_each_type_is_set_unchanged() -> None:
    box = ParameterBox()
    box.registry.apply({"a": 4, "count": 5, "kind": "y", "on": True})
    assert box.registry.values() == box.held
    assert box.held == {"a": 4.0, "b": 2.0, "count": 5, "kind": "y", "on": True, "rest": 0.0}
    assert box.held == {"a": 4.0, "b": 2.0, "count": 5, "kind": "y", "on": True, "rest": 0.0}
    assert type(box.held["a"]) is float


ANYTHING = st.one_of(st.floats(), st.integers(), st.text(), st.booleans(), st.none(), st.lists(st.floats()))


@given(values=st.dictionaries(st.sampled_from(["a", "b", "count", "kind", "on", "nothing"]), ANYTHING))
def test_any_request_is_applied_completely_or_not_at_all(values: dict[str, Any]) -> None:
    box = ParameterBox()
    before = dict(box.held)
    try:
        box.registry.apply(values)
    except RefusedError:
        assert box.held == before
    else:
        assert box.held == before | values
    assert all(-5 <= box.held[name] <= 5 for name in "ab")


def test_a_partial_change_sets_valid_values_and_gives_reasons_for_the_rest() -> None:
    box = ParameterBox()
    left_out = box.registry.apply({"a": 4, "b": 9, "gone": 1}, partly=True)
    assert (box.held["a"], box.held["b"]) == (4.0, 2.0)
    assert left_out == {
        "b": "b is 9; it must lie between -5 and 5 m",
        "gone": "there is no parameter 'gone'",
    }


def test_parameters_for_a_disarmed_robot_are_refused_while_armed() -> None:
    box = ParameterBox()
    box.armed = True
    with pytest.raises(RefusedError, match="rest can only be changed while the robot is disarmed"):
        box.registry.apply({"rest": 1, "a": 4})
    # Setting the present value is no change.
    box.registry.apply({"rest": 0, "a": 4})
    assert box.held["a"] == 4.0


def test_nothing_is_set_where_present_values_differ_from_the_expected() -> None:
    box = ParameterBox()
    with pytest.raises(RefusedError, match="and not 3 any more"):
        box.registry.apply({"a": 2}, expected={"a": 3})
    box.registry.apply({"a": 2}, expected={"a": 1})
    assert box.held["a"] == 2.0


def test_what_differs_from_the_expected_is_left_out_of_a_partial_change() -> None:
    box = ParameterBox()
    left_out = box.registry.apply({"a": 2, "b": 4.0}, expected={"a": 3}, partly=True)
    assert (box.held["a"], box.held["b"]) == (1.0, 4.0)
    assert left_out.keys() == {"a"}


def test_changes_are_reported_with_the_previous_values() -> None:
    box = ParameterBox()
    with box.registry.changing() as changed:
        box.registry.apply({"a": 4, "b": 2.0})
    assert changed == {"a": (1.0, 4.0)}


def test_defaults_are_the_values_at_the_start() -> None:
    box = ParameterBox()
    box.registry.apply({"a": 4})
    listed = {parameter.name: parameter for parameter in box.registry.listed()}
    assert (listed["a"].value, listed["a"].default) == (4.0, 1.0)


def test_a_change_waits_for_the_running_tick() -> None:
    box = ParameterBox()
    changed = threading.Event()

    def change() -> None:
        box.registry.apply({"a": 4, "b": 4})
        changed.set()

    with box.tick_lock:
        thread = threading.Thread(target=change)
        thread.start()
        seen = [(box.held["a"], box.held["b"]) for _ in range(1000)]
        assert not changed.is_set()
    thread.join()
    assert set(seen) == {(1.0, 2.0)}
    assert (box.held["a"], box.held["b"]) == (4.0, 4.0)
