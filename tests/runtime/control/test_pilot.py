"""Pilot's inputs: accepted, or dropped and counted."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_runtime.clock import SimulatedClock
from robot_runtime.control.pilot import AGE_MAX, NEUTRAL, PATIENCE, Pilot
from robot_runtime.errors import RefusedError

LEFT = [0.0, -1.0, 0.0, 0.0, 0.0, 0.25]


@pytest.fixture
def clock() -> SimulatedClock:
    return SimulatedClock(100.0)


@pytest.fixture
def pilot(clock: SimulatedClock) -> Pilot:
    pilot = Pilot(clock)
    pilot.change_lease(3)
    pilot.begin()
    return pilot


def message_of(**more: Any) -> bytes:
    return json.dumps({"lease": 3, "sequence": 7, "taken": 100.0, "axes": LEFT} | more).encode()


def test_the_newest_input_counts_until_it_expires(pilot: Pilot, clock: SimulatedClock) -> None:
    assert pilot.command() == NEUTRAL
    pilot.take(message_of())
    assert (pilot.command().y, pilot.command().yaw) == (-1.0, 0.25)
    clock.forward(PATIENCE - 0.01)
    assert pilot.command().y == -1.0
    assert pilot.next_check == pytest.approx(clock.now() + 0.01)
    clock.forward(0.02)
    assert pilot.command() == NEUTRAL
    assert not pilot.dropped


@pytest.mark.parametrize(
    ("reason", "more"),
    [
        ("lease", {"lease": 2}),
        ("lease", {"lease": 4}),
        ("sequence", {"sequence": 6}),
        ("sequence", {"sequence": 5}),
        ("age", {"taken": 100.0 - AGE_MAX - 0.001}),
        ("age", {"taken": 100.0 + AGE_MAX + 0.001}),
        ("invalid", {"axes": LEFT[:5]}),
        ("invalid", {"axes": [*LEFT, 0.0]}),
        ("invalid", {"axes": [1.001, 0, 0, 0, 0, 0]}),
        ("invalid", {"axes": [float("nan"), 0, 0, 0, 0, 0]}),
        ("invalid", {"axes": [True, 0, 0, 0, 0, 0]}),
        ("invalid", {"axes": [10**400, 0, 0, 0, 0, 0]}),
        ("invalid", {"taken": float("inf")}),
        ("invalid", {"taken": None}),
        ("invalid", {"sequence": 7.5}),
        ("invalid", {"sequence": 2**80}),
        ("invalid", {"lease": "3"}),
    ],
)
def test_invalid_stale_or_foreign_input_is_dropped_and_counted(
    pilot: Pilot, reason: str, more: dict[str, Any]
) -> None:
    pilot.take(message_of(sequence=6, axes=[0.5, 0, 0, 0, 0, 0]))
    pilot.take(message_of(**more))
    assert pilot.command().x == 0.5
    assert pilot.dropped == {reason: 1}


SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
INPUTS = st.fixed_dictionaries(dict.fromkeys(("lease", "sequence", "taken", "axes"), SCALARS))


@given(st.binary() | (SCALARS | INPUTS).map(json.dumps).map(str.encode))
def test_any_bytes_are_handled(data: bytes) -> None:
    pilot = Pilot(SimulatedClock())
    pilot.take(data)
    assert pilot.dropped == {"invalid": 1}
    assert pilot.command() == NEUTRAL


def test_a_new_holder_begins_with_centred_sticks(pilot: Pilot) -> None:
    pilot.take(message_of())
    pilot.change_lease(3)
    assert pilot.command().y == -1.0
    pilot.change_lease(4)
    assert pilot.command() == NEUTRAL
    pilot.take(message_of(sequence=8))
    assert pilot.dropped == {"lease": 1}
    pilot.take(message_of(lease=4, sequence=0))
    assert pilot.command().y == -1.0
    with pytest.raises(RefusedError, match="older than 4"):
        pilot.change_lease(3)


@pytest.mark.parametrize("epoch", [2**80, 2**53, 102_001, -1])
def test_a_lease_that_is_not_of_this_time_locks_nobody_out(pilot: Pilot, epoch: int) -> None:
    with pytest.raises(RefusedError, match="not of this time"):
        pilot.change_lease(epoch)
    assert pilot.take(message_of())


def test_the_start_of_manual_drops_earlier_input(pilot: Pilot) -> None:
    pilot.take(message_of())
    pilot.begin()
    assert pilot.command() == NEUTRAL
